// SPDX-License-Identifier: BSD-3-Clause
// Makes a small atlas: one submap, whose few keyframes see a few landmarks, and one lost frame.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "map_server/atlas/atlas.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi::tool {

inline Submap make_test_submap(int keyframes = 4, int landmarks = 20) {
  Submap submap;
  submap.key = {1, 1};
  submap.camera = test_camera();
  submap.revision = 1;
  for (int i = 0; i < landmarks; ++i) {
    Landmark landmark;
    landmark.id = i;
    landmark.position = {std::sin(i), std::cos(i), 4 + 0.1 * i};
    landmark.revision = 1;
    submap.landmarks[i] = landmark;
  }
  for (int k = 0; k < keyframes; ++k) {
    Keyframe keyframe;
    keyframe.id = k;
    keyframe.utime_us = 1'000'000 + 100'000 * k;
    keyframe.cam_from_submap = SE3(Eigen::Quaterniond::Identity(), {-0.1 * k, 0.02 * k * k, 0});
    keyframe.revision = keyframe.created_revision = 1;
    auto features = std::make_shared<Features>();
    for (int i = 0; i < landmarks; ++i) {
      const auto pixel = submap.camera.project(keyframe.cam_from_submap * submap.landmarks[i].position);
      features->keypoints.push_back({pixel->cast<float>(), 0, 0});
      features->descriptors.push_back({});
    }
    features->undistort(submap.camera);
    keyframe.features = features;
    keyframe.landmark_ids.assign(landmarks, kNone);
    submap.keyframes[k] = keyframe;
    for (int i = 0; i < landmarks; ++i) submap.add_observation(i, k, i);
    FramePose frame;
    frame.utime_us = keyframe.utime_us;
    frame.reference_keyframe = k;
    frame.revision = 1;
    submap.frames.set(frame);
  }
  return submap;
}

inline map_server::Atlas make_test_atlas() {
  map_server::Atlas atlas;
  const Submap submap = make_test_submap();
  EXPECT_TRUE(atlas.change_submap(submap.key, [&](Submap* target) {
    *target = submap;
    return Result<>();
  }));
  for (const auto& [utime_us, frame] : submap.frames) atlas.record_frame({utime_us}, {1, TrackingState::kTracking, 1});
  atlas.record_frame({1'400'000}, {1, TrackingState::kLost, kNoSubmap});
  return atlas;
}

}  // namespace rumi::tool
