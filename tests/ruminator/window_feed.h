// SPDX-License-Identifier: BSD-3-Clause
// Feeds frames to a WindowSampler and collects the windows.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "ruminator/window/window_sampler.h"

namespace rumi::ruminator {

inline std::vector<int64_t> utimes(const std::vector<Sample>& samples) {
  std::vector<int64_t> list;
  list.reserve(samples.size());
  for (const Sample& s : samples) list.push_back(s.utime_us);
  return list;
}

inline std::vector<int64_t> keyframes(const std::vector<Sample>& samples) {
  std::vector<int64_t> list;
  for (const Sample& s : samples)
    if (s.is_keyframe) list.push_back(s.utime_us);
  return list;
}

// Returns a different pose for each frame.
inline SE3 pose_of(int64_t utime_us) {
  return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(static_cast<double>(utime_us), 0, 1)};
}

// Feeds frames 1, 2, 3, ... (also their utime). span() feeds `frames` frames of one state, in which every n-th is a
// keyframe.
class WindowFeed {
 public:
  explicit WindowFeed(const WindowOptions& options = {}) : sampler(options) {}
  void span(int frames, int32_t submap, int keyframe_every = 0, bool has_image = true) {
    for (int i = 0; i < frames; ++i) {
      ++now;
      const bool is_keyframe = submap != kNoSubmap && keyframe_every > 0 && i % keyframe_every == 0;
      auto ended = sampler.process({.utime_us = now,
                                    .session = session,
                                    .submap_id = submap,
                                    .cam_from_submap = submap == kNoSubmap ? SE3() : pose_of(now),
                                    .is_keyframe = is_keyframe,
                                    .has_image = has_image,
                                    .image = {.motion_px = motion_px, .sharpness = 1}});
      if (ended) windows.push_back(*ended);
    }
  }
  // Feeds a frame again, with a late pose.
  void late_pose(int64_t utime, int32_t submap, bool is_keyframe = false) {
    auto ended = sampler.process({.utime_us = utime,
                                  .session = session,
                                  .submap_id = submap,
                                  .cam_from_submap = pose_of(utime),
                                  .is_keyframe = is_keyframe});
    EXPECT_FALSE(ended);
  }
  // Feeds frames again, without their poses, which are withdrawn.
  void withdraw(int64_t first, int64_t last) {
    for (int64_t utime = first; utime <= last; ++utime)
      EXPECT_FALSE(sampler.process({.utime_us = utime, .session = session}));
  }
  void finish() {
    if (auto ended = sampler.finish("the input ended")) windows.push_back(*ended);
  }
  WindowSampler sampler;
  std::vector<RuminationWindow> windows;
  int64_t now = 0, session = 7;
  double motion_px = 5;
};

}  // namespace rumi::ruminator
