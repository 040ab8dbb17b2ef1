// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "formats/camera/camera_file.h"
#include "slam/numeric/median.h"
#include "synth/sequence_renderer.h"
#include "synth/write_sequence.h"
#include "tests/support/temporary_folder.h"

namespace rumi::synth {
namespace {

using ::testing::HasSubstr;
using Kind = HardPassage::Kind;

SynthOptions small_options() {
  SynthOptions options;
  options.seed = 4;
  options.seconds = 6;
  options.rate_hz = 10;
  options.camera = default_synth_camera(320, 240);
  options.grey = true;
  return options;
}

int corners(const cv::Mat& grey) {
  std::vector<cv::KeyPoint> found;
  cv::FAST(grey, found, 20);
  return static_cast<int>(found.size());
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

std::vector<std::pair<cv::Point2f, cv::Point2f>> track(const cv::Mat& a, const cv::Mat& b) {
  std::vector<cv::Point2f> from, to, back;
  std::vector<uchar> ok, ok_back;
  std::vector<float> error;
  cv::goodFeaturesToTrack(a, from, 400, 0.01, 8);
  cv::calcOpticalFlowPyrLK(a, b, from, to, ok, error, {15, 15}, 4);
  cv::calcOpticalFlowPyrLK(b, a, to, back, ok_back, error, {15, 15}, 4);
  std::vector<std::pair<cv::Point2f, cv::Point2f>> pairs;
  for (size_t i = 0; i < from.size(); ++i)
    if (ok[i] && ok_back[i] && cv::norm(from[i] - back[i]) < 0.2) pairs.emplace_back(from[i], to[i]);
  return pairs;
}

SynthOptions along(const testing::TemporaryFolder& folder, const std::string& poses) {
  SynthOptions options = small_options();
  options.rate_hz = 0;
  options.path_file = folder.write("path.txt", poses);
  options.camera.k1 = -0.28;
  options.camera.k2 = 0.07;
  options.camera.p1 = 0.002;
  options.camera.p2 = -0.001;
  options.camera.cx += 7;
  options.camera.fy *= 1.03;
  options.noise = 0;
  options.exposure_s = 0;
  options.exposure_swing = 0;
  return options;
}

Eigen::Vector2d eigen(cv::Point2f p) { return {p.x, p.y}; }

// Tests all conventions at once: direction of poses, order of quaternions, axes, pixel centres, distortion.
TEST(Truth, RotationMovesThePictureAsPredicted) {
  const testing::TemporaryFolder folder;
  SequenceRenderer renderer(
      along(folder, "1 0.3 -0.2 1.5 -0.5 0.5 -0.5 0.5\n1.1 0.3 -0.2 1.5 -0.4797 0.5195 -0.4997 0.5001\n"));
  const SE3 b_from_a = renderer.map_from_cam(1).inverse() * renderer.map_from_cam(0);
  ASSERT_GT(b_from_a.angle_rad(), 0.03);
  std::vector<double> errors;
  for (const auto& [a, b] : track(renderer.render(0), renderer.render(1))) {
    const auto predicted = renderer.camera().project(b_from_a.rotation * renderer.camera().unproject(eigen(a)));
    ASSERT_TRUE(predicted);
    errors.push_back((*predicted - eigen(b)).norm());
  }
  ASSERT_GT(errors.size(), 100u);
  EXPECT_LT(median(&errors), 0.15);
}

TEST(Truth, TranslationKeepsToTheEpipolarLinesAndDepthsArePositive) {
  const testing::TemporaryFolder folder;
  SequenceRenderer renderer(
      along(folder, "1 0.3 -0.2 1.5 -0.5 0.5 -0.5 0.5\n1.1 0.33 -0.12 1.53 -0.4897 0.5095 -0.4997 0.5001\n"));
  const SE3 b_from_a = renderer.map_from_cam(1).inverse() * renderer.map_from_cam(0);
  const Eigen::Matrix3d essential = skew(b_from_a.translation) * b_from_a.rotation.toRotationMatrix();
  const Camera& camera = renderer.camera();
  std::vector<double> errors;
  int in_front = 0;
  for (const auto& [a, b] : track(renderer.render(0), renderer.render(1))) {
    const Eigen::Vector3d ray_a = camera.unproject(eigen(a)), ray_b = camera.unproject(eigen(b));
    const Eigen::Vector3d line = essential * ray_a;
    errors.push_back(camera.fx * std::abs(line.dot(ray_b)) / line.head<2>().norm());
    // Solves for the depths along the two rays by least squares: depth_b ray_b - depth_a R ray_a = t.
    Eigen::Matrix<double, 3, 2> m;
    m << ray_b, -(b_from_a.rotation * ray_a);
    const Eigen::Vector2d depths = m.colPivHouseholderQr().solve(b_from_a.translation);
    in_front += depths.x() > 0.3 && depths.x() < 12;
  }
  ASSERT_GT(errors.size(), 100u);
  EXPECT_LT(median(&errors), 0.15);
  EXPECT_GT(in_front, 0.9 * static_cast<double>(errors.size()));
}

TEST(Sequence, IsTheSameForTheSameSeedInAnyOrder) {
  const SynthOptions options = small_options();
  SequenceRenderer one(options), two(options);
  ASSERT_EQ(one.frames(), 60);
  const cv::Mat late = one.render(50), early = one.render(3);
  EXPECT_TRUE(equal(two.render(3), early));
  EXPECT_TRUE(equal(two.render(50), late));
  SynthOptions other = options;
  other.seed = 5;
  EXPECT_FALSE(equal(SequenceRenderer(other).render(3), early));
  EXPECT_EQ(early.type(), CV_8UC1);
}

TEST(Sequence, HasCornersEverywhere) {
  SynthOptions options = small_options();
  options.camera = default_synth_camera(640, 480);
  options.seconds = 20;
  SequenceRenderer renderer(options);
  for (int i = 0; i < renderer.frames(); i += 20) EXPECT_GT(corners(renderer.render(i)), 600) << "frame " << i;
}

TEST(Sequence, HardPassagesDoWhatTheyPromiseAndOnlyThere) {
  SynthOptions easy = small_options(), hard = easy;
  hard.hard = {
      {Kind::kBlur, 1.0, 0.8}, {Kind::kDark, 2.0, 0.8}, {Kind::kTextureless, 3.0, 0.8}, {Kind::kRotation, 4.0, 1.0}};
  SequenceRenderer plain(easy), changed(hard);
  for (const int i : {0, 9, 19, 29, 39, 51}) EXPECT_TRUE(equal(plain.render(i), changed.render(i))) << "frame " << i;
  EXPECT_LT(corners(changed.render(14)), 0.05 * corners(plain.render(14)));
  const cv::Mat dark = changed.render(24);
  EXPECT_LT(cv::mean(dark)[0], 12);
  EXPECT_EQ(corners(dark), 0);
  const cv::Mat blank = changed.render(34);
  EXPECT_EQ(corners(blank), 0);
  EXPECT_NEAR(cv::mean(blank)[0], 128, 60);
  const SE3 before = plain.map_from_cam(45), turned = changed.map_from_cam(45);
  EXPECT_NEAR((before.inverse() * turned).angle_rad() * 180 / M_PI, 110, 1);
  EXPECT_LT((before.translation - turned.translation).norm(), 1e-12);
  EXPECT_FALSE(equal(plain.render(45), changed.render(45)));
}

TEST(Sequence, TheWalkIntoTheNextRoomBringsItsHardPassage) {
  SynthOptions options = small_options();
  options.walk = WalkKind::kNextRoom;
  options.seconds = 20;
  SequenceRenderer renderer(options);
  const double before = cv::mean(renderer.render(80))[0], dark = cv::mean(renderer.render(100))[0];
  EXPECT_LT(dark, 0.8 * before);
  EXPECT_GT(dark, 12) << "not too dark for SIFT";
  EXPECT_GT(corners(renderer.render(80)), 150);
  EXPECT_LT(corners(renderer.render(100)), 0.2 * corners(renderer.render(80)));
  // In a part of the sequence, the passage comes at the same place of the path.
  options.start_s = 9;
  options.duration_s = 2;
  SequenceRenderer part(options);
  EXPECT_LT((part.map_from_cam(10).translation - renderer.map_from_cam(100).translation).norm(), 1e-9);
  EXPECT_NEAR(cv::mean(part.render(10))[0], dark, 0.3 * dark);
}

TEST(Sequence, OptionErrorsNameTheField) {
  const auto error = [](auto change) {
    SynthOptions options = small_options();
    change(options);
    return options.check().error_text();
  };
  EXPECT_EQ(error([](SynthOptions&) {}), "");
  EXPECT_THAT(error([](SynthOptions& o) { o.seconds = -1; }), HasSubstr("seconds is -1"));
  EXPECT_THAT(error([](SynthOptions& o) { o.seconds = NAN; }), HasSubstr("seconds"));
  EXPECT_THAT(error([](SynthOptions& o) { o.noise = 1e9; }), HasSubstr("noise"));
  EXPECT_THAT(error([](SynthOptions& o) { o.camera.fx = NAN; }), HasSubstr("fx"));
  EXPECT_THAT(error([](SynthOptions& o) { o.camera = default_synth_camera(9000, 9000); }), HasSubstr("9000x9000"));
  EXPECT_THAT(error([](SynthOptions& o) { o.hard = {{Kind::kBlur, 1, 0}}; }), HasSubstr("for is 0"));
  SynthOptions late = small_options();
  late.start_s = 100;
  EXPECT_THROW(SequenceRenderer{late}, std::runtime_error);
  SynthOptions absurd = small_options();
  absurd.camera.k1 = 40;
  absurd.camera.k2 = -900;
  EXPECT_THROW(SequenceRenderer{absurd}, std::runtime_error);
  EXPECT_EQ(parse_hard_kind("dark"), Kind::kDark);
  EXPECT_THAT(parse_hard_kind("fog").error_text(), HasSubstr("fog"));
  EXPECT_THAT(error([](SynthOptions& o) { o.hard = {{Kind::kBlur, 1, 1, 1.5}}; }), HasSubstr("strength is 1.5"));
  EXPECT_THAT(error([](SynthOptions& o) { o.walk = WalkKind::kNextRoom; }), HasSubstr("seconds of the walk next-room"));
  EXPECT_EQ(parse_walk_kind("next-room"), WalkKind::kNextRoom);
  EXPECT_THAT(parse_walk_kind("moon").error_text(), HasSubstr("moon"));
  EXPECT_EQ(parse_walk_kind("storeys"), WalkKind::kStoreys);
  EXPECT_THAT(error([](SynthOptions& o) { o.walk = WalkKind::kSquare; }), HasSubstr("what repeats is 6"));
  EXPECT_THAT(error([](SynthOptions& o) { o.alike = 1.5; }), HasSubstr("alike is 1.5"));
}

TEST(WriteSequence, MakesATumFolder) {
  const testing::TemporaryFolder folder;
  SynthOptions options = small_options();
  options.seconds = 0.5;
  options.camera.k1 = -0.1;
  int calls = 0;
  const auto progress = [&](int, int) { return ++calls > 0; };
  ASSERT_EQ(write_sequence(options, folder / "out", false, progress).error_text(), "");
  EXPECT_EQ(calls, 5);
  EXPECT_THAT(write_sequence(options, folder / "out", false, progress).error_text(), HasSubstr("--overwrite"));
  std::ifstream list(folder / "out/rgb.txt"), truth(folder / "out/groundtruth.txt");
  std::string line;
  std::getline(list, line);
  for (int i = 0; i < 5; ++i) {
    std::string time, name;
    ASSERT_TRUE(list >> time >> name);
    EXPECT_EQ(name, "rgb/" + time + ".jpg");
    const cv::Mat image = cv::imread(folder / "out/" + name, cv::IMREAD_UNCHANGED);
    EXPECT_EQ(image.size(), cv::Size(320, 240));
    EXPECT_EQ(image.channels(), 1);
  }
  const Result<CameraFile> camera = read_camera_file(folder / "out/calibration.yaml");
  ASSERT_TRUE(camera.has_value()) << camera.error_text();
  EXPECT_EQ(camera->camera.k1, -0.1);
  int poses = 0;
  while (std::getline(truth, line)) poses += line[0] != '#';
  EXPECT_EQ(poses, 5);
}

TEST(WriteSequence, SaysWhatCannotBeWritten) {
  SynthOptions options = small_options();
  options.seconds = 0.5;
  EXPECT_THAT(write_sequence(options, "/proc/nothing/here", false, {}).error_text(), HasSubstr("/proc/nothing"));
  const testing::TemporaryFolder folder;
  EXPECT_EQ(write_sequence(options, folder.path(), false, [](int, int) { return false; }).error_text(), "stopped");
  EXPECT_FALSE(std::filesystem::exists(folder / "rgb.txt"));  // an unfinished folder must not look finished
}

}  // namespace
}  // namespace rumi::synth
