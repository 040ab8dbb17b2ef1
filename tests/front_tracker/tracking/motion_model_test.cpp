// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/motion_model.h"

#include <gtest/gtest.h>

#include "tests/front_tracker/feature_scene.h"

namespace rumi::front_tracker {
namespace {

Frame frame_at(int64_t utime_us, double x) {
  Frame frame;
  frame.utime_us = utime_us;
  frame.cam_from_submap = SyntheticScene::pose(x, 0, 0);
  return frame;
}

TEST(MotionModel, WhatTheCameraDidGoesOn) {
  MotionModel motion;
  motion.begin_at(frame_at(0, 0));
  EXPECT_FALSE(motion.is_known());
  EXPECT_EQ(motion.predict(100'000).center().x(), 0) << "nothing is known: it stays";
  motion.go_on(frame_at(100'000, 0.2));
  EXPECT_TRUE(motion.is_known());
  EXPECT_NEAR(motion.predict(200'000).center().x(), 0.4, 1e-12);
  EXPECT_NEAR(motion.predict(150'000).center().x(), 0.3, 1e-12) << "half the time, half the way";
  EXPECT_NEAR(motion.predict(5'000'000).center().x(), 0.8, 1e-12) << "but not for ever";
  motion.begin_at(frame_at(5'000'000, 3));
  EXPECT_EQ(motion.predict(5'100'000).center().x(), 3) << "found elsewhere";
}

TEST(MotionModel, TheLastFrameGoesWhereMappingMovesItsKeyframe) {
  Submap map;
  map.keyframes[1].id = 1;
  map.keyframes[2].id = 2;
  map.keyframes[2].cam_from_submap = SyntheticScene::pose(0.5, 0, 0);
  Frame last = frame_at(100'000, 1);
  last.reference_keyframe = 1;
  last.cam_from_keyframe = last.cam_from_submap;
  map.frames.set({last.utime_us, 1, last.cam_from_keyframe});
  MotionModel motion;
  motion.begin_at(last);

  map.keyframes[1].cam_from_submap = SyntheticScene::pose(0, 0.25, 0);
  motion.follow_mapping(map);
  EXPECT_TRUE(motion.last().cam_from_submap.center().isApprox(Eigen::Vector3d(1, 0.25, 0)));

  map.remove_keyframe(1, 2);
  map.keyframes[2].cam_from_submap = SyntheticScene::pose(0.5, 0, 2);
  motion.follow_mapping(map);
  EXPECT_EQ(motion.last().reference_keyframe, 2) << "its keyframe was culled";
  EXPECT_TRUE(motion.last().cam_from_submap.center().isApprox(Eigen::Vector3d(1, 0.25, 2)));
}

// A turn moves points by the focal length times the angle, unless they are near the image's border.
TEST(MotionModel, TheMotionOfTheImageIsAShareOfItsWidth) {
  FeatureScene scene(1);
  const auto submap = scene.submap({SE3(), SyntheticScene::pose(0.3, 0, 0)});
  Frame last;
  last.cam_from_submap = SE3();
  MotionModel motion;
  motion.begin_at(last);
  const auto turned_by = [&](double yaw_rad) {
    const SE3 cam_from_submap = SyntheticScene::pose(0, 0, 0, yaw_rad);
    Features features;
    for (const auto& [id, lm] : submap->map.landmarks) {
      features.keypoints.push_back({test_camera().project_undistorted(cam_from_submap * lm.position).cast<float>()});
      features.descriptors.push_back({});
    }
    Frame frame = make_frame(1, std::move(features), test_camera());
    frame.landmark_ids.clear();
    for (const auto& [id, lm] : submap->map.landmarks) frame.landmark_ids.push_back(id);
    return motion.image_motion(submap->map, frame);
  };
  EXPECT_NEAR(turned_by(0), 0, 1e-6);
  EXPECT_NEAR(turned_by(0.02), 0.02 * test_camera().fx / test_camera().width, 0.002);
  EXPECT_EQ(motion.image_motion(submap->map, Frame()), 0) << "nothing is seen";
}

}  // namespace
}  // namespace rumi::front_tracker
