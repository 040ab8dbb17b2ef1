// SPDX-License-Identifier: BSD-3-Clause
#include "tests/ruminator/test_jobs.h"

#include <opencv2/core.hpp>

#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_image.h"

namespace rumi::testing {
using namespace rumi::ruminator;
namespace {

constexpr int64_t kPeriodUs = 100'000;

image_t noise_image(int64_t utime_us) {
  cv::Mat grey(120, 160, CV_8U);
  cv::RNG rng(static_cast<uint64_t>(utime_us));
  rng.fill(grey, cv::RNG::UNIFORM, 0, 255);
  image_t image = make_jpeg_image(utime_us, grey, 50);
  set_metadata(&image, kCalibrationKey, camera_to_yaml(small_camera()));
  return image;
}

}  // namespace

Camera small_camera() {
  Camera c;
  c.width = 160, c.height = 120;
  c.fx = 130.5, c.fy = 131.25, c.cx = 79.5, c.cy = 59.75;
  c.k1 = 0.01, c.p2 = -0.0005;
  return c;
}

WindowJob small_job(int32_t id, int64_t session) {
  WindowJob job;
  RuminationWindow& w = job.window;
  w.id = id;
  w.session = session;
  w.submap_before = 1;
  w.submap_after = 3;
  w.gap_frames = 9;
  w.reason = "a reason";
  int64_t utime = 1'000'000'000 + id * 100 * kPeriodUs;
  const auto fill = [&](std::vector<Sample>* part, int count, int32_t submap) {
    for (int i = 0; i < count; ++i, utime += kPeriodUs) {
      Sample sample{.utime_us = utime, .is_keyframe = submap != kNoSubmap && i % 2 == 0, .submap_id = submap};
      if (submap != kNoSubmap) sample.cam_from_submap = {so3_exp({0.01 * i, 0.2, 0}), Eigen::Vector3d(0.1 * i, 0, 1)};
      part->push_back(sample);
      job.images.push_back(noise_image(utime));
    }
  };
  fill(&w.approach, 4, 1);
  fill(&w.gap, 5, kNoSubmap);
  fill(&w.departure, 3, 3);
  w.lost_utime_us = w.gap.front().utime_us;
  w.resumed_utime_us = w.departure.front().utime_us;
  job.camera = small_camera();
  return job;
}

Submap fake_submap(const WindowJob& job) {
  Submap submap;
  submap.key = {job.window.session, -job.window.id};
  submap.kind = SubmapKind::kBack;
  submap.camera = job.camera;
  submap.closed = true;
  submap.revision = 1;
  for (const image_t& image : job.images) {
    Keyframe keyframe;
    keyframe.id = static_cast<int>(submap.keyframes.size());
    keyframe.utime_us = image.utime;
    keyframe.cam_from_submap.translation = {0.1 * keyframe.id, 0, 0};
    auto features = std::make_shared<Features>();
    features->keypoints.push_back({{10, 20}, 0, 0});
    features->descriptors.emplace_back();
    keyframe.features = features;
    keyframe.landmark_ids = {kNone};
    keyframe.revision = keyframe.created_revision = 1;
    submap.frames.set({image.utime, keyframe.id, SE3(), 1});
    submap.keyframes[keyframe.id] = std::move(keyframe);
  }
  Landmark landmark;
  landmark.id = 0;
  landmark.position = {0, 0, 5};
  landmark.revision = 1;
  submap.landmarks[0] = landmark;
  for (const auto& [id, keyframe] : submap.keyframes) submap.add_observation(0, id, 0);
  return submap;
}

BuildResult fake_result(const WindowJob& job) {
  BuildResult result;
  result.submap = fake_submap(job);
  result.approach = static_cast<int>(job.window.approach.size());
  result.gap = static_cast<int>(job.window.gap.size());
  result.departure = static_cast<int>(job.window.departure.size());
  result.error_px = 0.5;
  result.models_tried = 1;
  return result;
}

Builder fake_builder(std::atomic<int>* built) {
  return [built](const WindowJob& job, const std::string& work_folder,
                 const std::function<void(const BuildProgress&)>& progress, const std::atomic<bool>&) {
    std::filesystem::create_directories(work_folder);
    for (const BuildStage stage : {BuildStage::kExtracting, BuildStage::kMatching, BuildStage::kMapping})
      progress({stage, 0.5, 3});
    std::filesystem::remove_all(work_folder);
    if (built) ++*built;
    return fake_result(job);
  };
}

}  // namespace rumi::testing
