// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/view_collector.h"

#include <gmock/gmock.h>

#include "bus/transport/memory_bus.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_image.h"
#include "rumi/calibration/capture.h"
#include "tests/rumi/calibration/board_scene.h"

namespace rumi::tool {
namespace {

using ::testing::AllOf;
using testing::BoardPose;
using testing::BoardScene;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Board board_of(const std::string& text) { return parse_board(text).value(); }

class Collecting : public ::testing::Test {
 protected:
  bool add(const cv::Mat& grey) { return collector_.add(make_grey_image(++utime_us_, grey), "an image"); }
  // Returns an image with the board's middle at (x, y), in parts of the image's size, and tilted.
  cv::Mat view(double x, double y, double tilt_x_rad, double tilt_y_rad, const testing::Optics& optics = {},
               double degrees = 40) const {
    const Eigen::Vector2d pixel(x * camera_.width, y * camera_.height);
    return scene_.render(scene_.pose(pixel, degrees, tilt_x_rad, tilt_y_rad, 0.1), optics, 1);
  }

  const Camera camera_ = testing::pinhole_camera(480, 360);
  const Board board_;
  const BoardScene scene_{board_, camera_};
  ViewCollector collector_{board_, {}};
  int64_t utime_us_ = 0;
};

struct DetectionCase {
  const char* board;
  bool fisheye;
  int views;
  size_t fewest;  // at least so many views must show the board
  double max_rms_px, max_bias_px;
};

class BoardDetectorTest : public ::testing::TestWithParam<DetectionCase> {};

// This also tests the pixel convention: another origin of pixels would give a bias of 0.5.
TEST_P(BoardDetectorTest, FindsCornersWhereTheyAre) {
  const DetectionCase& param = GetParam();
  const Board board = board_of(param.board);
  const int width = board.kind == Board::Kind::kCharuco ? 640 : 480;  // looking for a chessboard takes long
  const Camera camera = (param.fisheye ? testing::fisheye_camera : testing::pinhole_camera)(width, width * 3 / 4);
  const BoardScene scene(board, camera);
  const BoardDetector detector(board);
  size_t views = 0, corners = 0;
  double squares = 0;
  Eigen::Vector2d bias(0, 0);
  for (const BoardPose& pose : scene.varied_poses(param.views, param.fisheye ? 90 : 45, width == 640 ? 0.15 : 0.3)) {
    const BoardDetection detection = detector.detect(scene.render(pose, {}, static_cast<int>(views)));
    if (detection.outcome != BoardDetection::Outcome::kFound) continue;
    ++views;
    const auto error_of = [&](size_t i, bool turned) {
      // A chessboard looks the same upside down.
      const int corner = turned ? board.corners() - 1 - detection.view.corners[i] : detection.view.corners[i];
      const cv::Point2d mm = board.corner_mm(corner);
      const auto pixel = camera.project(pose.rotation * Eigen::Vector3d(mm.x, mm.y, 0) + pose.translation);
      return Eigen::Vector2d(detection.view.pixels[i].x - pixel->x(), detection.view.pixels[i].y - pixel->y());
    };
    const bool turned = board.kind == Board::Kind::kChessboard && error_of(0, false).norm() > 10;
    for (size_t i = 0; i < detection.view.corners.size(); ++i, ++corners) {
      bias += error_of(i, turned);
      squares += error_of(i, turned).squaredNorm();
    }
  }
  ASSERT_GE(views, param.fewest);
  bias /= static_cast<double>(corners);
  EXPECT_LT(bias.cwiseAbs().maxCoeff(), param.max_bias_px);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(corners)), param.max_rms_px);
}
INSTANTIATE_TEST_SUITE_P(, BoardDetectorTest,
                         ::testing::Values(DetectionCase{"charuco:9x7:26:19", false, 12, 11, 0.2, 0.03},
                                           DetectionCase{"charuco:9x7:26:19", true, 12, 12, 0.2, 0.03},
                                           DetectionCase{"chessboard:9x7:26", false, 8, 7, 0.15, 0.03},
                                           DetectionCase{"chessboard:9x7:26", true, 8, 7, 0.15, 0.03}));

TEST(BoardDetector, SeesNoBoardInNoise) {
  cv::Mat noise(240, 320, CV_8U);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 256);
  for (const char* board : {"charuco:9x7:26:19", "chessboard:9x7:26"})
    EXPECT_EQ(BoardDetector(board_of(board)).detect(noise).outcome, BoardDetection::Outcome::kNone) << board;
}

TEST(BoardDetector, TinyImagesShowNoBoard) {
  for (const char* board : {"charuco:9x7:26:19", "chessboard:9x7:26"})
    for (const int side : {1, 2, 7, 16})
      EXPECT_EQ(BoardDetector(board_of(board)).detect(cv::Mat(side, side, CV_8U, cv::Scalar(9))).outcome,
                BoardDetection::Outcome::kNone);
}

TEST(BoardDetector, AnotherBoardOfTheSameMarkersIsNotThisOne) {
  const Camera camera = testing::pinhole_camera(640, 480);
  const BoardScene scene(board_of("charuco:7x5:30:22"), camera);
  const cv::Mat image = scene.render(scene.pose({320, 240}, 35, 0.2, 0.1, 0), {}, 1);
  EXPECT_EQ(BoardDetector(board_of("charuco:7x5:30:22")).detect(image).outcome, BoardDetection::Outcome::kFound);
  EXPECT_EQ(BoardDetector(board_of("charuco:9x7:26:19")).detect(image).outcome, BoardDetection::Outcome::kOtherBoard);
  EXPECT_EQ(BoardDetector(board_of("charuco:9x7:26:19:5X5_50")).detect(image).outcome, BoardDetection::Outcome::kNone);
}

TEST_F(Collecting, TakesWhatIsSharpAndNew) {
  EXPECT_TRUE(add(view(0.5, 0.5, 0, 0)));
  EXPECT_TRUE(add(view(0.5, 0.5, 0, 0)));
  EXPECT_TRUE(add(view(0.51, 0.5, 0.03, 0)));
  EXPECT_EQ(collector_.counts().taken, 1);
  EXPECT_EQ(collector_.counts().similar, 2);
  EXPECT_EQ(collector_.spare().size(), 2u);
  add(view(0.7, 0.5, 0, 0));    // elsewhere
  add(view(0.5, 0.5, 0.5, 0));  // tilted
  EXPECT_EQ(collector_.counts().taken, 3);
  add(cv::Mat(camera_.height, camera_.width, CV_8U, cv::Scalar(90)));
  EXPECT_EQ(collector_.counts().no_board, 1);
  EXPECT_EQ(collector_.counts().to_string(), "6 images: 3 views taken, 2 like these, 1 without the board");
}

// A chessboard is found even if it is very blurred.
TEST(ViewCollector, LeavesBlurredViewsOut) {
  const Board board = board_of("chessboard:9x7:26");
  const Camera camera = testing::pinhole_camera(480, 360);
  const BoardScene scene(board, camera);
  const BoardDetector detector(board);
  ViewCollector collector(board, {});
  double before = 0;
  for (const double blur : {0.5, 1.0, 1.5, 2.0, 3.0}) {
    const cv::Mat image = scene.render(scene.pose({240, 180}, 45, 0.1, 0.1, 0.1), {blur, 1}, 1);
    const BoardDetection detection = detector.detect(image);
    ASSERT_EQ(detection.outcome, BoardDetection::Outcome::kFound);
    EXPECT_GT(detection.view.blur_px, before + 0.3) << blur;
    before = detection.view.blur_px;
    collector.add(make_grey_image(1, image), "an image");
  }
  EXPECT_EQ(collector.counts().taken, 1);
  EXPECT_EQ(collector.counts().similar, 2) << "up to a standard deviation of 1.5 pixels";
  EXPECT_EQ(collector.counts().blurred, 2);
}

TEST(ViewCollector, RefusesABoardWithMarkersAsAChessboard) {
  const Camera camera = testing::pinhole_camera(640, 480);
  const auto problem_of = [&camera](const std::string& shown) {
    ViewCollector collector(board_of("chessboard:9x7:26"), {});
    const BoardScene scene(board_of(shown), camera);
    const bool added =
        collector.add(make_grey_image(1, scene.render(scene.pose({320, 240}, 42, 0.1, 0.1, 0.1), {}, 1)), "a.png");
    EXPECT_EQ(collector.counts().with_board(), 1) << shown;
    EXPECT_EQ(added, collector.problem().empty());
    return collector.problem();
  };
  EXPECT_EQ(problem_of("chessboard:9x7:26"), "");
  EXPECT_THAT(problem_of("charuco:9x7:26:19:4X4_50"), HasSubstr("give --board charuco:9x7:26:MARKER_MM:4X4_50"));
  EXPECT_THAT(problem_of("charuco:9x7:26:19:5X5_100"), HasSubstr("give --board charuco:9x7:26:MARKER_MM:5X5_"));
}

TEST_F(Collecting, ImagesOfAnotherSizeAreRefused) {
  EXPECT_TRUE(add(view(0.5, 0.5, 0, 0)));
  EXPECT_FALSE(add(cv::Mat(camera_.width, camera_.height, CV_8U, cv::Scalar(90))));
  EXPECT_THAT(collector_.problem(), HasSubstr("is 360 x 480 pixels, the images before it are 480 x 360"));
}

TEST_F(Collecting, TellsHowTheBoardIsTilted) {
  const auto shape = [&](double tilt_x, double tilt_y) {
    const BoardDetection detection = BoardDetector(board_).detect(view(0.5, 0.5, tilt_x, tilt_y));
    return shape_of(detection.view, board_, {camera_.width, camera_.height});
  };
  EXPECT_LT(shape(0, 0).tilt(), 12);
  // If the board turns about the axis that points down, its right side comes nearer: it recedes to the left.
  EXPECT_NEAR(shape(0.6, 0).tilt_x, -34, 8);
  EXPECT_NEAR(shape(-0.6, 0).tilt_x, 34, 8);
  EXPECT_NEAR(shape(0, 0.6).tilt_y, 34, 8);
  EXPECT_NEAR(shape(0, -0.6).tilt_y, -34, 8);
  const ViewShape frontal = shape(0, 0);
  EXPECT_NEAR(frontal.x, 0.5, 0.03);
  EXPECT_NEAR(frontal.y, 0.5, 0.03);
}

TEST_F(Collecting, SaysWhatIsMissingUntilNothingIs) {
  for (const auto& [x, y] : {std::pair(0.3, 0.3), {0.7, 0.3}, {0.3, 0.7}}) add(view(x, y, 0, 0));
  EXPECT_THAT(collector_.coverage().missing(),
              AllOf(Contains(HasSubstr("hold the board at the lower right corner")),
                    Contains(HasSubstr("turn its left or right side")), Contains(HasSubstr("turn its upper or lower")),
                    Contains("hold it nearer, so that it fills most of the image"), Contains("17 more views")));
  EXPECT_THAT(collector_.coverage().to_text(), HasSubstr("3 views; corners in"));
  for (const BoardPose& pose : scene_.varied_poses(30, 45)) add(scene_.render(pose, {}, 1));
  EXPECT_THAT(collector_.coverage().missing(), IsEmpty());
}

TEST_F(Collecting, LiveImagesComeFromTheBus) {
  MemoryBus bus;
  collect_from_bus(bus, &collector_);
  bus.publish(channels::kCamera, make_jpeg_image(1000, view(0.5, 0.5, 0, 0)));
  image_t broken = make_jpeg_image(2000, view(0.2, 0.5, 0, 0));
  broken.data.resize(100);
  broken.size = 100;
  bus.publish(channels::kCamera, broken);
  bus.dispatch();
  EXPECT_EQ(collector_.counts().images, 2);
  EXPECT_EQ(collector_.counts().taken, 1);
  EXPECT_EQ(collector_.counts().unreadable, 1);
  bus.publish(channels::kCamera, make_grey_image(3000, cv::Mat(10, 10, CV_8U, cv::Scalar(0))));
  bus.publish(channels::kCamera, make_grey_image(4000, view(0.7, 0.5, 0, 0)));
  bus.dispatch();
  EXPECT_THAT(collector_.problem(), HasSubstr("is 10 x 10 pixels"));
  EXPECT_EQ(collector_.counts().taken, 1) << "after a problem nothing is taken";
}

}  // namespace
}  // namespace rumi::tool
