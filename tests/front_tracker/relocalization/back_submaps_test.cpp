// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/relocalization/back_submaps.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/front_tracker/feature_scene.h"

namespace rumi::front_tracker {
namespace {

constexpr int kMostKeyframes = 12;

// Returns a back submap of room `seed`, seen from five places.
Submap back_submap(unsigned seed, int id, int64_t begin_us = 0) {
  FeatureScene scene(seed);
  std::vector<SE3> poses;
  poses.reserve(5);
  for (int i = 0; i < 5; ++i) poses.push_back(SyntheticScene::pose(0.12 * i, 0.02 * i, 0.03 * i, -0.02 * i));
  Submap submap = scene.submap(poses)->map;
  submap.key = {1, id};
  submap.kind = SubmapKind::kBack;
  submap.closed = true;
  submap.frames = {};
  for (auto& [kf_id, kf] : submap.keyframes) {
    kf.utime_us += begin_us;
    submap.frames.set({kf.utime_us, kf_id, SE3(), 1});
  }
  return submap;
}

Frame view_of(unsigned seed, const SE3& truth) {
  FeatureScene scene(seed);
  return scene.frame(1, truth);
}

class BackSubmapsTest : public testing::Test {
 protected:
  BackSubmapsTest() {
    TrackingOptions options;
    options.back_keyframes = kMostKeyframes;
    back_ = std::make_unique<BackSubmaps>(test_camera(), options, Pyramid());
  }
  std::string add(Submap submap) { return back_->add(std::move(submap)).error_text(); }
  const SE3 truth_ = SyntheticScene::pose(0.2, 0.05, 0.05, -0.05);
  std::unique_ptr<BackSubmaps> back_;
};

TEST_F(BackSubmapsTest, TheCameraIsFoundInItsRoomAndInNoOther) {
  ASSERT_EQ(add(back_submap(1, -1)), "");
  ASSERT_EQ(add(back_submap(2, -2, 1'000'000)), "");
  EXPECT_FALSE(back_->relocalize(view_of(3, truth_)));
  const auto found = back_->relocalize(view_of(2, truth_));
  ASSERT_TRUE(found);
  const Submap& submap = found->submap;
  const Frame& frame = found->frame;
  EXPECT_EQ(submap.key.id, -2);
  EXPECT_LT((frame.cam_from_submap.center() - truth_.center()).norm(), 0.03);
  EXPECT_GT(frame.matches(), 0);
  for (int id : frame.landmark_ids) EXPECT_TRUE(id == kNone || submap.landmark(id)) << id;
  EXPECT_TRUE(submap.keyframe(frame.reference_keyframe));
  EXPECT_EQ(back_->submaps(), 1u) << "it is not kept any longer";
  Frame again = view_of(2, truth_), other = view_of(1, truth_);
  EXPECT_FALSE(back_->relocalize(again));
  EXPECT_TRUE(back_->relocalize(other)) << "the other one is still there";
}

TEST_F(BackSubmapsTest, TheOldestGo) {
  EXPECT_EQ(add(back_submap(2, -2, 2'000'000)), "");
  EXPECT_EQ(add(back_submap(3, -3, 4'000'000)), "");
  EXPECT_EQ(add(back_submap(1, -1, 0)), "") << "came late, and is the first to go";
  EXPECT_EQ(back_->submaps(), 2u);
  EXPECT_LE(back_->keyframes(), kMostKeyframes);
  EXPECT_EQ(add(back_submap(4, -4, 6'000'000)), "");
  EXPECT_LE(back_->keyframes(), kMostKeyframes);
  Frame two = view_of(2, truth_), three = view_of(3, truth_), four = view_of(4, truth_);
  EXPECT_FALSE(back_->relocalize(two));
  EXPECT_TRUE(back_->relocalize(three));
  EXPECT_TRUE(back_->relocalize(four));
}

TEST_F(BackSubmapsTest, TheSameOnceMoreIsOne) {
  for (int i = 0; i < 5; ++i) EXPECT_EQ(add(back_submap(1, -1)), "");
  EXPECT_EQ(back_->submaps(), 1u);
  Frame here = view_of(1, truth_), again = view_of(1, truth_);
  EXPECT_TRUE(back_->relocalize(here));
  EXPECT_FALSE(back_->relocalize(again));
}

TEST_F(BackSubmapsTest, WhatTheMapNoLongerHoldsIsForgotten) {
  EXPECT_EQ(add(back_submap(1, -1)), "");
  back_->remove(-7);
  EXPECT_EQ(back_->submaps(), 1u);
  back_->remove(-1);
  Frame here = view_of(1, truth_);
  EXPECT_FALSE(back_->relocalize(here));
  EXPECT_EQ(back_->keyframes(), 0);
}

TEST_F(BackSubmapsTest, IdsAreMadeSmallAndInOrderOfTime) {
  const Submap submap = back_submap(1, -1);
  Submap shuffled = submap;
  shuffled.keyframes.clear();
  shuffled.landmarks.clear();
  shuffled.frames = {};
  const auto keyframe_id = [](int id) { return kMaxKeyframeId - id; };
  const auto landmark_id = [](int id) { return IdMap<Landmark>::kMaxId - 100'000 + id; };
  for (const auto& [id, kf] : submap.keyframes) {
    Keyframe& other = shuffled.keyframes[keyframe_id(id)] = kf;
    other.id = keyframe_id(id);
    std::fill(other.landmark_ids.begin(), other.landmark_ids.end(), kNone);
  }
  for (const auto& [id, lm] : submap.landmarks) {
    Landmark& other = shuffled.landmarks[landmark_id(id)];
    other.id = landmark_id(id);
    other.position = lm.position;
    for (const Observation& o : lm.observations)
      shuffled.add_observation(other.id, keyframe_id(o.keyframe_id), o.keypoint_index);
  }
  ASSERT_EQ(add(shuffled), "");
  const auto relocalized = back_->relocalize(view_of(1, truth_));
  ASSERT_TRUE(relocalized);
  const Submap* found = &relocalized->submap;
  ASSERT_EQ(found->keyframes.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(found->keyframe(i));
    EXPECT_EQ(found->keyframe(i)->utime_us, 100'000 * (i + 1));
    EXPECT_EQ(found->frame(100'000 * (i + 1))->reference_keyframe, i);
  }
  EXPECT_EQ(found->landmarks.size(), submap.landmarks.size());
  EXPECT_EQ(found->landmarks.rbegin()->first, static_cast<int>(submap.landmarks.size()) - 1);
  for (const auto& [id, lm] : found->landmarks) {
    EXPECT_GE(lm.observations.size(), 2u);
    EXPECT_GT(lm.octave0_distance, 0);
  }
}

TEST_F(BackSubmapsTest, WhatATrackerCannotUseIsRefusedByNameAndValue) {
  const auto refusal = [&](const std::function<void(Submap*)>& spoil) {
    Submap submap = back_submap(1, -1);
    spoil(&submap);
    return add(std::move(submap));
  };
  const auto expect = [](const std::string& refused, const std::string& words) {
    EXPECT_NE(refused.find(words), std::string::npos) << refused;
  };
  expect(refusal([](Submap* s) { s->kind = SubmapKind::kFront; }), "not a back submap");
  expect(refusal([](Submap* s) { s->camera.fx = 400; }), "fx 400");
  expect(refusal([](Submap* s) { s->camera.width = 320; }), "320 x 480");
  expect(refusal([](Submap* s) { s->keyframe(3)->utime_us = s->keyframe(1)->utime_us; }), "keyframes 1 and 3");
  expect(refusal([](Submap* s) { s->keyframe(4)->cam_from_submap.translation.x() = 1e300; }), "keyframe 4");
  expect(refusal([](Submap* s) { s->landmarks.begin()->second.position.y() = -1e200; }), "landmark 0");
  expect(
      refusal([](Submap* s) { s->landmarks.begin()->second.position.y() = std::numeric_limits<double>::quiet_NaN(); }),
      "landmark 0");
  expect(refusal([](Submap* s) { s->pyramid = {4, 1.4}; }), "another pyramid: 4 levels, each 1.4 of the last");
  expect(refusal([](Submap* s) {
           for (int i = 5; i <= kMostKeyframes; ++i) {
             Keyframe& kf = s->keyframes[i] = *s->keyframe(0);
             kf.id = i;
             kf.utime_us = 1'000'000 + i;
           }
         }),
         "13 keyframes, 12 are kept");
  EXPECT_EQ(back_->submaps(), 0u);
  EXPECT_EQ(refusal([](Submap*) {}), "");
  EXPECT_EQ(back_->submaps(), 1u);
  EXPECT_NE(refusal([](Submap* s) { s->camera.fx = 400; }), "");
  Frame here = view_of(1, truth_);
  EXPECT_TRUE(back_->relocalize(here)) << "a refused one takes nothing away";
}

TEST_F(BackSubmapsTest, AnEmptyOneIsNoPlace) {
  Submap empty;
  empty.key = {1, -1};
  empty.kind = SubmapKind::kBack;
  empty.camera = test_camera();
  EXPECT_EQ(add(empty), "");
  EXPECT_EQ(back_->submaps(), 0u);
}

}  // namespace
}  // namespace rumi::front_tracker
