// SPDX-License-Identifier: BSD-3-Clause
// From the images of a window to the back submap, with the installed COLMAP and without.
#include "ruminator/rebuild/back_submap_builder.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <opencv2/core.hpp>

#include "bus/wire/image_codec.h"
#include "bus/wire/submap_update.h"
#include "slam/geometry/alignment.h"
#include "tests/ruminator/rendered_window.h"
#include "tests/support/temporary_folder.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::rendered_window;
using testing::RenderedWindow;
using testing::TemporaryFolder;

const std::atomic<bool> kNever = false;
const auto kNoProgress = [](const BuildProgress&) {};

BuildOptions quick_options() {
  BuildOptions options;
  options.sift_keypoints = 300;  // enough for small pictures; sanitizers make matching slow
  return options;
}

BuildOptions without_colmap() {
  BuildOptions options = quick_options();
  options.colmap = "/no/such/colmap";
  return options;
}

double ate_over_path(const RenderedWindow& window, const Submap& submap) {
  std::vector<Eigen::Vector3d> found, truth;
  double length = 0;
  for (size_t i = 0; i < window.cam_from_map.size(); ++i) {
    if (i > 0) length += (window.cam_from_map[i].center() - window.cam_from_map[i - 1].center()).norm();
    if (const FramePose* frame = submap.frame(window.job.images[i].utime)) {
      found.push_back(submap.cam_from_submap(*frame).center());
      truth.push_back(window.cam_from_map[i].center());
    }
  }
  const auto map_from_submap = umeyama(found, truth);
  if (!map_from_submap) return 1;
  double square = 0;
  for (size_t i = 0; i < found.size(); ++i) square += (*map_from_submap * found[i] - truth[i]).squaredNorm();
  return std::sqrt(square / static_cast<double>(found.size())) / length;
}

std::vector<uint8_t> wire(const Submap& submap) {
  const submap_update_t update = make_submap_update(submap, 0);
  std::vector<uint8_t> bytes(static_cast<size_t>(update.getEncodedSize()));
  update.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

void expect_whole(const RenderedWindow& window, const BuildResult& result) {
  ASSERT_TRUE(result.submap) << result.submap.error_text();
  const Submap& submap = *result.submap;
  EXPECT_EQ(submap.key, (SubmapKey{77, -3}));
  EXPECT_EQ(submap.kind, SubmapKind::kBack);
  EXPECT_TRUE(submap.closed);
  EXPECT_EQ(submap.revision, 1);
  EXPECT_EQ(result.approach, 7);
  EXPECT_EQ(result.gap, 6);
  EXPECT_EQ(result.departure, 7);
  EXPECT_EQ(submap.keyframes.size(), 20U);
  EXPECT_GT(submap.landmarks.size(), 500U);
  for (const auto& [id, landmark] : submap.landmarks) EXPECT_NE(landmark.descriptor, Descriptor{});
  EXPECT_LT(result.error_px, 1.2);
  EXPECT_LT(ate_over_path(window, submap), 0.01);
  ASSERT_EQ(result.agreement.size(), 2U);
  for (const FrontAgreement& agreement : result.agreement) {
    EXPECT_EQ(agreement.frames, 7);
    EXPECT_LT(agreement.rotation_deg, 1);
    EXPECT_LT(agreement.position_ratio, 0.1);
  }
  Submap received;
  received.key = submap.key;
  EXPECT_EQ(apply_submap_update(make_submap_update(submap, 0), &received).error_text(), "");
  EXPECT_EQ(received.keyframes.size(), submap.keyframes.size());
  EXPECT_EQ(received.landmarks.size(), submap.landmarks.size());
}

TEST(BackSubmapBuilder, RebuildsARenderedWindow) {
  const RenderedWindow& window = rendered_window();
  const TemporaryFolder folder;
  std::vector<BuildProgress> reports;
  const BuildResult result = build_back_submap(
      window.job, quick_options(), folder / "work", [&](const BuildProgress& p) { reports.push_back(p); }, kNever);
  expect_whole(window, result);
  EXPECT_GE(result.models_tried, 1);
  EXPECT_GT(result.cpu_s, 0);
  EXPECT_FALSE(fs::exists(folder / "work"));
  EXPECT_TRUE(std::is_sorted(reports.begin(), reports.end(), [](const BuildProgress& a, const BuildProgress& b) {
    return std::pair(a.stage, a.fraction) < std::pair(b.stage, b.fraction);
  }));
  ASSERT_FALSE(reports.empty());
  EXPECT_EQ(reports.back().stage, BuildStage::kMapping);
  for (const BuildProgress& p : reports) EXPECT_TRUE(p.fraction >= 0 && p.fraction <= 1) << p.fraction;

  // A second run, without a progress handler, gives the same result bit by bit.
  const BuildResult again = build_back_submap(window.job, quick_options(), folder / "work", {}, kNever);
  ASSERT_TRUE(again.submap);
  EXPECT_EQ(wire(*again.submap), wire(*result.submap));
}

// The tests from here on need no COLMAP.
TEST(BackSubmapBuilder, LargeImagesAreWorkedOnSmaller) {
  const RenderedWindow& window = rendered_window();
  const TemporaryFolder folder;
  BuildOptions options = without_colmap();
  options.max_image_side = 240;
  const BuildResult result = build_back_submap(window.job, options, folder / "work", kNoProgress, kNever);
  ASSERT_TRUE(result.submap) << result.submap.error_text();
  EXPECT_EQ(result.submap->camera.width, 240);
  EXPECT_EQ(result.submap->camera.height, 180);
  EXPECT_LT(ate_over_path(window, *result.submap), 0.03);
  for (const auto& [id, keyframe] : result.submap->keyframes)
    for (const Eigen::Vector2f& pixel : keyframe.features->undistorted)
      ASSERT_TRUE(result.submap->camera.contains(pixel.cast<double>()));
}

TEST(BackSubmapBuilder, LeavesOutWhatItCannotUse) {
  WindowJob job = rendered_window().job;
  job.images[2].data.resize(200);  // a truncated JPEG
  job.images[2].size = 200;
  testing::replace_image(&job, 4, cv::Mat(100, 100, CV_8U, cv::Scalar(90)));
  testing::replace_image(&job, 17, cv::Mat(240, 320, CV_8U, cv::Scalar(0)));
  job.images[18].data.assign(10, 0);
  job.images[18].size = 10;
  const TemporaryFolder folder;
  const BuildResult result = build_back_submap(job, without_colmap(), folder / "work", kNoProgress, kNever);
  ASSERT_TRUE(result.submap) << result.submap.error_text();
  EXPECT_THAT(result.warning, HasSubstr("/no/such/colmap"));
  EXPECT_EQ(result.approach, 5);
  EXPECT_EQ(result.gap, 6);
  EXPECT_EQ(result.departure, 5);
  EXPECT_LT(ate_over_path(rendered_window(), *result.submap), 0.01);
}

TEST(BackSubmapBuilder, CanBeCancelledInEveryStage) {
  const RenderedWindow& window = rendered_window();
  const TemporaryFolder folder;
  std::atomic<bool> cancel = true;
  const BuildResult at_once = build_back_submap(window.job, quick_options(), folder / "work", kNoProgress, cancel);
  EXPECT_TRUE(at_once.cancelled);
  EXPECT_FALSE(at_once.submap);
  EXPECT_FALSE(fs::exists(folder / "work"));
  for (const BuildStage stage : {BuildStage::kExtracting, BuildStage::kMatching, BuildStage::kMapping}) {
    cancel = false;
    int calls_after = 0;
    const auto progress = [&](const BuildProgress& p) {
      calls_after += cancel;
      if (p.stage == stage) cancel = true;
    };
    const BuildResult result = build_back_submap(window.job, quick_options(), folder / "work", progress, cancel);
    EXPECT_TRUE(result.cancelled);
    EXPECT_FALSE(result.submap);
    EXPECT_LE(calls_after, 1);
    EXPECT_FALSE(fs::exists(folder / "work"));
  }
}

struct Hopeless {
  const char* name;
  void (*spoil)(WindowJob*);
  const char* failure;
};

class HopelessWindow : public ::testing::TestWithParam<Hopeless> {};

// The build fails with its reason before the first attempt.
TEST_P(HopelessWindow, FailsAtOnceWithItsReason) {
  WindowJob job = rendered_window().job;
  GetParam().spoil(&job);
  const TemporaryFolder folder;
  const BuildResult result = build_back_submap(job, quick_options(), folder / "work", kNoProgress, kNever);
  EXPECT_FALSE(result.submap);
  EXPECT_FALSE(result.cancelled);
  EXPECT_FALSE(result.retryable);
  EXPECT_THAT(result.submap.error_text(), HasSubstr(GetParam().failure));
  EXPECT_EQ(result.models_tried, 0);
}

// Shows the same picture in all images, with the noise of a sensor.
void stand_still(WindowJob* job) {
  const cv::Mat first = decode_grey(job->images[0]).value();
  cv::RNG random(1);
  for (size_t i = 0; i < job->images.size(); ++i) {
    cv::Mat noise(first.size(), CV_16S), noisy;
    random.fill(noise, cv::RNG::NORMAL, 0, 2);
    cv::add(first, noise, noisy, cv::noArray(), CV_8U);
    testing::replace_image(job, i, noisy);
  }
}

void blacken(WindowJob* job, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) testing::replace_image(job, i, cv::Mat(240, 320, CV_8U, cv::Scalar(0)));
}

INSTANTIATE_TEST_SUITE_P(
    All, HopelessWindow,
    ::testing::Values(Hopeless{"NoImages", [](WindowJob* job) { job->images.clear(); }, "of 0 images"},
                      Hopeless{"OneImage", [](WindowJob* job) { job->images.resize(1); }, "of 1 images"},
                      Hopeless{"AllBlack", [](WindowJob* job) { blacken(job, 0, 20); }, "no three have enough"},
                      Hopeless{"BlackGap", [](WindowJob* job) { blacken(job, 7, 13); },
                               "none of the 6 images of the gap"},
                      Hopeless{"StandingStill", stand_still, "stands still"},
                      Hopeless{"AllBroken",
                               [](WindowJob* job) {
                                 for (image_t& image : job->images) image.data.resize(image.size = 50);
                               },
                               "of 0 images"}),
    [](const auto& window) { return window.param.name; });

TEST(BackSubmapBuilder, SaysWhereItCannotWork) {
  const BuildResult result =
      build_back_submap(rendered_window().job, quick_options(), "/proc/nothing/here", kNoProgress, kNever);
  EXPECT_THAT(result.submap.error_text(), HasSubstr("/proc/nothing/here"));
  EXPECT_TRUE(result.retryable);
}

}  // namespace
}  // namespace rumi::ruminator
