// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/submap.h"

#include <gtest/gtest.h>

#include "slam/map/landmark_view.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

Submap small_submap() {
  Submap map;
  map.revision = 1;
  for (int id = 0; id < 3; ++id) {
    auto features = std::make_shared<Features>();
    for (int i = 0; i < 5; ++i) {
      features->keypoints.push_back({{10.0f * i, 5}, 0, static_cast<uint8_t>(i % 2)});
      features->descriptors.push_back({static_cast<uint64_t>(i), 0, 0, 0});
    }
    map.add_keyframe({.id = id,
                      .utime_us = 1000 * id,
                      .cam_from_submap = SyntheticScene::pose(id, 0, 0),
                      .features = features,
                      .landmark_ids = {}});
    map.set_frame({1000 * id, id, SE3()});
  }
  for (int id = 0; id < 2; ++id) map.add_landmark(id, {0.5, 0, 4});
  return map;
}

// Expects that each observation is stored both in its keyframe and in its landmark.
void expect_consistent(const Submap& map) {
  size_t forward = 0, backward = 0;
  for (const auto& [id, kf] : map.keyframes)
    for (size_t i = 0; i < kf.landmark_ids.size(); ++i) {
      if (kf.landmark_ids[i] == kNone) continue;
      ++forward;
      ASSERT_NE(map.landmark(kf.landmark_ids[i]), nullptr);
    }
  for (const auto& [id, lm] : map.landmarks)
    for (const Observation& o : lm.observations) {
      ++backward;
      ASSERT_EQ(map.keyframe(o.keyframe_id)->landmark_ids[o.keypoint_index], id);
    }
  EXPECT_EQ(forward, backward);
}

TEST(Submap, ObservationsGoBothWays) {
  Submap map = small_submap();
  EXPECT_TRUE(map.add_observation(0, 1, 2));
  EXPECT_TRUE(map.add_observation(0, 0, 3));
  EXPECT_FALSE(map.add_observation(0, 1, 4)) << "a landmark is seen once per keyframe";
  EXPECT_FALSE(map.add_observation(9, 1, 4));
  EXPECT_FALSE(map.add_observation(1, 9, 4));
  EXPECT_FALSE(map.add_observation(1, 1, 5));
  EXPECT_FALSE(map.add_observation(1, 1, -1));
  EXPECT_EQ(map.landmarks[0].observations[0].keyframe_id, 0);
  EXPECT_TRUE(map.add_observation(1, 1, 2)) << "the keypoint passes to the other landmark";
  EXPECT_EQ(map.landmarks[0].observations.size(), 1u);
  expect_consistent(map);
  map.remove_landmark(1);
  EXPECT_EQ(map.keyframe(1)->landmark_ids[2], kNone);
  EXPECT_EQ(map.removed_landmarks.since(map.revision - 1), std::vector<int>{1});
  expect_consistent(map);
}

TEST(Submap, FusionKeepsEveryObservationOnce) {
  Submap map = small_submap();
  map.add_observation(0, 0, 0);
  map.add_observation(0, 1, 1);
  map.add_observation(1, 1, 2);
  map.add_observation(1, 2, 3);
  map.fuse_landmarks(0, 1);
  EXPECT_EQ(map.landmark(1), nullptr);
  EXPECT_EQ(map.landmarks[0].observations.size(), 3u);
  EXPECT_EQ(map.keyframe(1)->landmark_ids[2], kNone);
  expect_consistent(map);
}

TEST(Submap, FramesOfARemovedKeyframeStayWhereTheyWere) {
  Submap map = small_submap();
  map.add_observation(0, 1, 1);
  map.add_observation(0, 0, 1);
  map.frames.set({1500, 1, SyntheticScene::pose(0.1, 0.2, 0, 0.1), 1});
  const SE3 before = map.cam_from_submap(*map.frame(1500));
  map.remove_keyframe(1, 9);
  EXPECT_NE(map.keyframe(1), nullptr) << "no heir, no removal";
  map.remove_keyframe(1, 0);
  EXPECT_EQ(map.keyframe(1), nullptr);
  EXPECT_EQ(map.frame(1500)->reference_keyframe, 0);
  EXPECT_LT((map.cam_from_submap(*map.frame(1500)).log() - before.log()).norm(), 1e-12);
  expect_consistent(map);
}

TEST(Submap, CovisibilityCountsSharedLandmarks) {
  Submap map = small_submap();
  map.add_observation(0, 0, 0);
  map.add_observation(0, 2, 0);
  map.add_observation(1, 0, 1);
  map.add_observation(1, 2, 1);
  map.add_observation(1, 1, 1);
  const auto covisible = map.covisible_keyframes(0);
  ASSERT_EQ(covisible.size(), 2u);
  EXPECT_EQ(covisible[0], (std::pair{2, 2}));
  EXPECT_EQ(covisible[1], (std::pair{1, 1}));
}

// If the revision did not rise with the first change after an update, the change would never be sent.
TEST(Submap, TheFirstChangeAfterAnUpdateIsOfANewRevision) {
  Submap map = small_submap();
  map.hand_out();
  const int64_t sent = map.revision;
  map.add_observation(0, 0, 0);
  EXPECT_EQ(map.revision, sent + 1);
  EXPECT_EQ(map.landmark(0)->revision, sent + 1);
  map.add_observation(0, 1, 0);
  EXPECT_EQ(map.revision, sent + 1) << "more of the same";
  map.hand_out();
  map.remove_landmark(1);
  EXPECT_EQ(map.revision, sent + 2);
  EXPECT_EQ(map.removed_landmarks.since(sent + 1), std::vector<int>{1});
}

// Returns a submap of one keyframe, one landmark and one frame that was handed out once.
Submap sent_submap() {
  Submap map;
  auto features = std::make_shared<Features>();
  features->keypoints.resize(2);
  map.add_keyframe({.id = 0, .utime_us = 1000, .cam_from_submap = {}, .features = features, .landmark_ids = {}});
  map.add_landmark(0, {0, 0, 4});
  map.add_observation(0, 0, 1);
  map.set_frame({1000, 0, SE3()});
  map.hand_out();
  return map;
}

TEST(Submap, EachKindOfChangeRaisesTheRevisionAndStampsWhatItChanges) {
  const Submap sent = sent_submap();
  EXPECT_EQ(sent.revision, 1);
  EXPECT_EQ(sent.keyframe(0)->landmark_ids, (std::vector<int>{kNone, 0}));
  Submap map = sent;
  map.move_keyframe(0, SyntheticScene::pose(1, 0, 0));
  EXPECT_EQ(map.keyframe(0)->revision, 2);
  EXPECT_EQ(map.keyframe(0)->created_revision, 1);
  map = sent;
  map.renew_features(0);
  EXPECT_EQ(map.keyframe(0)->created_revision, 2);
  map = sent;
  map.move_landmark(0, {0, 0, 5});
  EXPECT_EQ(map.landmark(0)->revision, 2);
  EXPECT_EQ(map.landmark(0)->position.z(), 5);
  map = sent;
  map.set_frame({2000, 0, SE3()});
  EXPECT_EQ(map.frame(2000)->revision, 2);
  map = sent;
  map.close();
  EXPECT_EQ(map.revision, 2);
  map.hand_out();
  map.close();
  EXPECT_EQ(map.revision, 2) << "it was closed already";
}

TEST(Submap, WhatDoesNotExistIsNotMoved) {
  Submap map = sent_submap();
  map.move_keyframe(7, {});
  map.move_landmark(7, {0, 0, 1});
  EXPECT_EQ(map.revision, 1);
}

TEST(Submap, WithoutSomeFramesItIsSentAsAWhole) {
  Submap map = sent_submap();
  map.set_frame({2000, 0, SE3()});
  map.remove_frames_from(2000);
  EXPECT_EQ(map.frames.size(), 1u);
  EXPECT_EQ(map.removed_keyframes.since(1), std::nullopt);
  EXPECT_EQ(map.removed_landmarks.since(1), std::nullopt);
  EXPECT_EQ(map.removed_landmarks.since(map.revision), std::vector<int>{});
}

TEST(Submap, AFrontSubmapMayBeginAsACopy) {
  Submap map = sent_submap();
  map.close();
  map.remove_frames_from(5000);
  map.begin_front_submap({7, 3});
  EXPECT_EQ(map.key, (SubmapKey{7, 3}));
  EXPECT_FALSE(map.closed);
  EXPECT_EQ(map.revision, 1);
  EXPECT_EQ(map.keyframe(0)->created_revision, 1);
  EXPECT_EQ(map.removed_keyframes.since(0), std::vector<int>{});
  map.move_landmark(0, {0, 0, 5});
  EXPECT_EQ(map.landmark(0)->revision, 1) << "nothing of it was sent";
}

TEST(Submap, APoseOnAKeyframeThatDoesNotExistIsNone) {
  const Submap map = small_submap();
  EXPECT_THROW(map.cam_from_submap(FramePose{1500, 99, SE3(), 1}), std::logic_error);
}

TEST(LandmarkView, PredictsTheOctaveItWasSeenAt) {
  Submap map = small_submap();
  map.add_observation(0, 0, 1);  // octave 1, from a distance of about 4
  const std::vector<double> scales{1.0, 1.2, 1.44, 1.728};
  Landmark* lm = map.landmark(0);
  update_landmark_view(map, lm);
  const double distance = lm->position.norm();
  EXPECT_NEAR(lm->view_direction.dot(lm->position) / distance, 1, 1e-9);
  EXPECT_EQ(lm->descriptor[0], 1u);
  EXPECT_EQ(predict_octave(*lm, distance * 1.0001, scales), 1);
  EXPECT_EQ(predict_octave(*lm, distance * 1.2001, scales), 0);
  EXPECT_EQ(predict_octave(*lm, distance * 0.1, scales), 3) << "clamped to the pyramid";
  EXPECT_EQ(predict_octave(*lm, 0, scales), 0);
}

}  // namespace
}  // namespace rumi
