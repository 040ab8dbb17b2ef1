// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/calibrator.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <map>
#include <random>

#include "tests/rumi/calibration/board_scene.h"

namespace rumi::tool {
namespace {

using testing::BoardPose;
using testing::BoardScene;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

cv::Size size_of(const Camera& camera) { return {camera.width, camera.height}; }

// Returns views with projected corners and noise, as a detector would find them.
std::vector<BoardView> projected_views(const Board& board, const Camera& camera, const std::vector<BoardPose>& poses,
                                       double noise_px) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, noise_px);
  std::vector<BoardView> views;
  for (const BoardPose& pose : poses) {
    BoardView& view = views.emplace_back();
    view.where = fmt::format("view {}", views.size() - 1);
    for (int corner = 0; corner < board.corners(); ++corner) {
      const cv::Point2d mm = board.corner_mm(corner);
      const auto pixel = camera.project(pose.rotation * Eigen::Vector3d(mm.x, mm.y, 0) + pose.translation);
      if (!pixel || !camera.contains(*pixel, 3)) continue;
      view.corners.push_back(corner);
      view.pixels.emplace_back(static_cast<float>(pixel->x() + noise(random)),
                               static_cast<float>(pixel->y() + noise(random)));
    }
    if (view.corners.size() < 20) views.pop_back();
  }
  return views;
}

std::vector<BoardView> detected_views(const Board& board, const BoardScene& scene, int count, double nearest_degrees) {
  const BoardDetector detector(board);
  std::vector<BoardView> views;
  int number = 0;
  for (const BoardPose& pose : scene.varied_poses(count, nearest_degrees)) {
    BoardDetection detection = detector.detect(scene.render(pose, {}, number));
    detection.view.where = fmt::format("image {}", number++);
    if (detection.outcome == BoardDetection::Outcome::kFound) views.push_back(std::move(detection.view));
  }
  return views;
}

// Returns the largest distance, in pixels, between the places at which the two cameras see the same ray. The rays cover
// the middle part of the second camera's image; `part_of_image` is the part of its width and height.
double largest_difference_px(const Camera& estimate, const Camera& truth, double part_of_image) {
  double largest = 0;
  for (int y = -4; y <= 4; ++y) {
    for (int x = -4; x <= 4; ++x) {
      const Eigen::Vector2d pixel(truth.width / 2.0 + x / 8.0 * part_of_image * truth.width,
                                  truth.height / 2.0 + y / 8.0 * part_of_image * truth.height);
      const auto seen = estimate.project(truth.unproject(pixel));
      largest = std::max(largest, seen ? (*seen - pixel).norm() : 1e9);
    }
  }
  return largest;
}

struct RecoveryCase {
  const char* board;
  bool fisheye;
  int images;
  double focal_px, centre_px;  // largest allowed errors
  // Largest allowed error of a pixel: in the middle 80 % of the image, and up to its corners.
  double middle_px, corner_px;
  double rms_px;
};

class Recovery : public ::testing::TestWithParam<RecoveryCase> {};

// Estimates a camera from rendered images, and prints its errors.
TEST_P(Recovery, OfTheCameraThatTookTheImages) {
  const RecoveryCase& param = GetParam();
  const Board board = parse_board(param.board).value();
  const int width = board.kind == Board::Kind::kCharuco ? 640 : 480;  // looking for a chessboard takes long
  const Camera truth = (param.fisheye ? testing::fisheye_camera : testing::pinhole_camera)(width, width * 3 / 4);
  const BoardScene scene(board, truth);
  std::vector<BoardView> views = detected_views(board, scene, param.images, param.fisheye ? 90 : 45);
  const size_t used = views.size() * 3 / 4;
  const std::vector<BoardView> spare(views.begin() + used, views.end());
  views.resize(used);
  const Result<Calibration> calibration = calibrate(board, views, spare, size_of(truth), truth.model, {});
  ASSERT_EQ(calibration.error_text(), "");
  EXPECT_THAT(calibration->doubts, IsEmpty());
  const Camera& c = calibration->camera;
  const double middle = largest_difference_px(c, truth, 0.8), corner = largest_difference_px(c, truth, 1);
  fmt::print("{} {}: {} views\n", param.fisheye ? "fisheye" : "pinhole", param.board, calibration->views);
  const std::map<std::string, double> truths = {{"fx", truth.fx}, {"fy", truth.fy}, {"cx", truth.cx}, {"cy", truth.cy},
                                                {"k1", truth.k1}, {"k2", truth.k2}, {"k3", truth.k3}, {"k4", truth.k4},
                                                {"p1", truth.p1}, {"p2", truth.p2}};
  for (const CalibratedParameter& p : calibration->parameters) {
    fmt::print("  {}  truth {:10.5f}  found {:10.5f} +- {:.5f}\n", p.name, truths.at(p.name), p.value, p.stddev);
    EXPECT_LT(std::abs(p.value - truths.at(p.name)), 4.5 * p.stddev)
        << p.name << ": the deviation that is told is true";
  }
  fmt::print("  a pixel is wrong by at most {:.3f} px in the middle 80 %, {:.3f} px up to the corners\n", middle,
             corner);
  fmt::print("  RMS {:.3f} px, {:.3f} px in {} other views\n", calibration->rms_px, calibration->check_rms_px,
             calibration->check_views);
  EXPECT_NEAR(c.fx, truth.fx, param.focal_px);
  EXPECT_NEAR(c.fy, truth.fy, param.focal_px);
  EXPECT_NEAR(c.cx, truth.cx, param.centre_px);
  EXPECT_NEAR(c.cy, truth.cy, param.centre_px);
  EXPECT_LT(middle, param.middle_px);
  EXPECT_LT(corner, param.corner_px);
  EXPECT_LT(calibration->rms_px, param.rms_px);
  EXPECT_EQ(calibration->check_views, spare.size());
  EXPECT_LT(calibration->check_rms_px, 2 * param.rms_px);
}
INSTANTIATE_TEST_SUITE_P(, Recovery,
                         ::testing::Values(RecoveryCase{"charuco:9x7:26:19", false, 40, 1.5, 1.5, 1.5, 1.5, 0.15},
                                           RecoveryCase{"charuco:9x7:26:19", true, 40, 0.3, 0.3, 0.3, 2.0, 0.15},
                                           RecoveryCase{"chessboard:9x7:26", false, 30, 1.5, 1.5, 1.5, 1.5, 0.1},
                                           RecoveryCase{"chessboard:9x7:26", true, 30, 0.3, 0.3, 0.3, 1.0, 0.1}));

class CalibratorTest : public ::testing::Test {
 protected:
  Result<Calibration> run(const std::vector<BoardView>& views, const std::vector<BoardView>& spare = {}) const {
    return calibrate(board_, views, spare, size_of(camera_), camera_.model, {});
  }
  std::vector<BoardView> views(int count, double noise_px = 0.1) const {
    return projected_views(board_, camera_, scene_.varied_poses(count, 45), noise_px);
  }
  const Camera camera_ = testing::pinhole_camera(480, 360);
  const Board board_;
  const BoardScene scene_{board_, camera_};
};

TEST_F(CalibratorTest, SameViewsSameCamera) {
  const std::vector<BoardView> data = views(20);
  const Result<Calibration> a = run(data), b = run(data);
  ASSERT_EQ(a.error_text(), "");
  EXPECT_EQ(a->camera.fx, b->camera.fx);
  EXPECT_EQ(a->camera.k2, b->camera.k2);
  EXPECT_EQ(a->rms_px, b->rms_px);
}

TEST_F(CalibratorTest, TellsTheNoiseOfTheCorners) {
  const Result<Calibration> calibration = run(views(30, 0.25), views(8, 0.25));
  ASSERT_EQ(calibration.error_text(), "");
  EXPECT_NEAR(calibration->rms_px, 0.25 * std::sqrt(2), 0.03) << "in x and y";
  EXPECT_NEAR(calibration->check_rms_px, 0.25 * std::sqrt(2), 0.04);
}

TEST_F(CalibratorTest, AThirdRadialTermIsUsedOnlyWhereThereIsOne) {
  EXPECT_EQ(run(views(20))->camera.k3, 0);
  Camera curved = camera_;
  curved.k3 = -0.2;
  const BoardScene scene(board_, curved);
  const Result<Calibration> calibration = calibrate(
      board_, projected_views(board_, curved, scene.varied_poses(30, 45), 0.02), {}, size_of(curved), curved.model, {});
  EXPECT_NEAR(calibration->camera.k3, -0.2, 0.05);
}

TEST_F(CalibratorTest, ViewsThatDoNotFitAreLeftOut) {
  std::vector<BoardView> data = views(20);
  for (size_t i = 0; i < data[4].pixels.size(); ++i) data[4].pixels[i].x += i % 2 == 0 ? 2.f : -2.f;
  const Result<Calibration> calibration = run(data);
  ASSERT_EQ(calibration.error_text(), "");
  EXPECT_THAT(calibration->outliers, ElementsAre(HasSubstr("view 4: ")));
  EXPECT_EQ(calibration->views, data.size() - 1);
  EXPECT_LT(calibration->rms_px, 0.2);
}

TEST_F(CalibratorTest, ManyViewsAreThinnedAndTheOthersCheckTheResult) {
  const std::vector<BoardView> data = views(80);
  const Result<Calibration> calibration = run(data);
  ASSERT_EQ(calibration.error_text(), "");
  EXPECT_LE(calibration->views, 50u);
  EXPECT_EQ(calibration->check_views, data.size() - 50);
  EXPECT_LT(calibration->check_rms_px, 0.2);
}

TEST_F(CalibratorTest, FewViewsAreRefused) {
  const Result<Calibration> calibration = run(views(6));
  EXPECT_THAT(calibration.error_text(), HasSubstr("6 different views of the board are too few: at least 8"));
  EXPECT_THAT(run({}).error_text(), HasSubstr("0 different views"));
}

// True if a user would accept the calibration.
bool is_believed(const Result<Calibration>& calibration) { return calibration && calibration->doubts.empty(); }

// The lens's distortion makes parallel boards look tilted and the fit is good, but the focal length is far off.
TEST_F(CalibratorTest, BoardsParallelToOneAnotherAreRefused) {
  for (const double tilt_rad : {0.0, 0.5}) {
    for (const Camera& camera : {camera_, testing::fisheye_camera(480, 360)}) {
      std::vector<BoardPose> poses = BoardScene(board_, camera).varied_poses(20, 45);
      for (size_t i = 0; i < poses.size(); ++i) {
        const Eigen::Vector3d middle(board_.width_mm() / 2, board_.height_mm() / 2, 0);
        const Eigen::Vector3d centre = poses[i].rotation * middle + poses[i].translation;
        poses[i].rotation = (Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()) *
                             Eigen::AngleAxisd(0.1 * static_cast<double>(i), Eigen::Vector3d::UnitZ()))
                                .toRotationMatrix();
        poses[i].translation = centre - poses[i].rotation * middle;
      }
      const Result<Calibration> calibration =
          calibrate(board_, projected_views(board_, camera, poses, 0.1), {}, size_of(camera), camera.model, {});
      EXPECT_FALSE(is_believed(calibration)) << tilt_rad;
      if (tilt_rad == 0 && camera.model == Camera::Model::kPinhole) {
        EXPECT_THAT(calibration.error_text(), HasSubstr("tilted by 15 degrees or more against the others"));
      }
    }
  }
}

TEST_F(CalibratorTest, AFocalLengthThatIsUncertainIsDoubtful) {
  // From far away there is hardly any perspective.
  std::vector<BoardPose> poses;
  for (int i = 0; i < 10; ++i) poses.push_back(scene_.pose({240.0 + i, 180}, 6, 0.1 * i - 0.5, 0, 0));
  const Result<Calibration> calibration = run(projected_views(board_, camera_, poses, 0.3));
  ASSERT_EQ(calibration.error_text(), "");
  EXPECT_THAT(calibration->doubts, ::testing::Contains(HasSubstr("fx is uncertain by ")));
}

TEST_F(CalibratorTest, ABoardThatIsNotFlatIsDoubtful) {
  std::vector<BoardView> data = views(20);
  for (BoardView& view : data)
    for (size_t i = 0; i < view.pixels.size(); ++i) view.pixels[i].y += view.corners[i] % 8 < 4 ? 3.f : -3.f;
  const Result<Calibration> calibration = run(data);
  ASSERT_EQ(calibration.error_text(), "");
  EXPECT_THAT(calibration->doubts, ::testing::Contains(HasSubstr("more than 1 px (--max-rms)")));
}

TEST_F(CalibratorTest, FisheyesOfAllWidths) {
  for (const double focal : {0.3, 0.35, 0.44, 0.6, 0.9}) {
    Camera camera = testing::fisheye_camera(480, 360);
    camera.fx = focal * camera.width;
    camera.fy = 1.01 * camera.fx;
    const std::vector<BoardPose> poses = BoardScene(board_, camera).varied_poses(30, 30 / focal);
    const Result<Calibration> calibration =
        calibrate(board_, projected_views(board_, camera, poses, 0.1), {}, size_of(camera), camera.model, {});
    ASSERT_EQ(calibration.error_text(), "") << focal;
    EXPECT_THAT(calibration->doubts, IsEmpty()) << focal;
    EXPECT_NEAR(calibration->camera.fx / camera.fx, 1, 0.003) << focal;
    EXPECT_LT(largest_difference_px(calibration->camera, camera, 0.7), 1.5) << focal;
  }
}

TEST_F(CalibratorTest, ViewsOfNothingAreAnErrorNotACrash) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> anywhere(0, 350);
  std::vector<BoardView> data = views(20);
  for (BoardView& view : data)
    for (cv::Point2f& pixel : view.pixels) pixel = {anywhere(random), anywhere(random)};
  for (const Camera::Model model : {Camera::Model::kPinhole, Camera::Model::kKannalaBrandt}) {
    const Result<Calibration> calibration = calibrate(board_, data, {}, size_of(camera_), model, {});
    EXPECT_FALSE(is_believed(calibration));
  }
}

}  // namespace
}  // namespace rumi::tool
