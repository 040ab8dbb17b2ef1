// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/post_culling.h"

#include <gtest/gtest.h>

#include "tests/map_server/test_atlas.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

// One back submap of five images. Each sees the same points, each at one keypoint of octave 2.
class FindRedundantTest : public ::testing::Test {
 protected:
  static constexpr int kImages = 5, kPoints = 10;
  const SubmapKey back_{1, -1}, front_{1, 1};

  FindRedundantTest() {
    submap_.key = back_;
    submap_.kind = SubmapKind::kBack;
    submap_.closed = true;
    Features features;
    features.keypoints.resize(kPoints);
    for (Keypoint& keypoint : features.keypoints) keypoint.octave = 2;
    model_.points.resize(kPoints);
    for (int v = 0; v < kImages; ++v) {
      submap_.keyframes[v].id = v;
      MapModel::View& view = model_.views.emplace_back();
      view.features = std::make_shared<Features>(features);
      view.points.assign(kPoints, kNone);
      view.keyframes = {{back_, v}};
      for (int p = 0; p < kPoints; ++p) model_.observe(p, v, p);
    }
    placed_[back_] = {&submap_, {}};
  }
  void set_octave(int view, int octave) {
    auto features = std::make_shared<Features>(*model_.views[view].features);
    for (Keypoint& keypoint : features->keypoints) keypoint.octave = static_cast<uint8_t>(octave);
    model_.views[view].features = features;
  }
  std::set<int> redundant() const {
    const KeyframeSets sets = find_redundant(model_, placed_, common_, options_);
    for (const auto& [key, keyframes] : sets) EXPECT_EQ(key, back_);
    return sets.empty() ? std::set<int>() : sets.at(back_);
  }

  Submap submap_;
  MapModel model_;
  std::map<SubmapKey, PlacedSubmap> placed_;
  CommonImages common_;
  PostCullingOptions options_;
};

TEST_F(FindRedundantTest, WhatThreeOthersSeeIsRedundantUntilThreeAreLeft) {
  EXPECT_EQ(redundant(), (std::set<int>{0, 1}));
}

TEST_F(FindRedundantTest, NearlyAllOfThePointsAreEnough) {
  for (int v = 1; v < kImages; ++v) model_.forget(0, v);
  EXPECT_EQ(redundant(), (std::set<int>{1, 2})) << "9 of the 10 points of image 0 are not more than 90 %";
  options_.redundant_share = 0.85;
  EXPECT_EQ(redundant(), (std::set<int>{0, 1}));
}

TEST_F(FindRedundantTest, WhoeverSeesThePointsLessFinelyDoesNotCount) {
  for (int v = 2; v < kImages; ++v) set_octave(v, 4);
  EXPECT_EQ(redundant(), (std::set<int>{2, 3})) << "0 and 1 see them best";
  set_octave(2, 3);
  set_octave(3, 3);
  EXPECT_EQ(redundant(), (std::set<int>{0, 2})) << "one octave is none";
}

TEST_F(FindRedundantTest, WhatIsNeededStays) {
  common_.needed[back_] = {0, 2, 3};
  EXPECT_EQ(redundant(), (std::set<int>{1, 4}));
  submap_.closed = false;
  EXPECT_TRUE(redundant().empty()) << "its maker goes on";
  submap_.closed = true;
  submap_.kind = SubmapKind::kFront;
  EXPECT_TRUE(redundant().empty()) << "front_tracker culls its own";
}

TEST_F(FindRedundantTest, OneKeyframeOfAnImageIsEnough) {
  Submap front;
  front.key = front_;
  front.keyframes[7].id = 7;
  placed_[front_] = {&front, {}};
  model_.views[4].keyframes.push_back({front_, 7});
  options_.observers = kImages;
  EXPECT_TRUE(redundant().empty()) << "they do not agree";
  common_.doubled.push_back({.a = {back_, 4}, .b = {front_, 7}, .b_from_a = {}});
  EXPECT_EQ(redundant(), (std::set<int>{4}));
  // If both submaps are back submaps, only one of the two keyframes goes.
  front.kind = SubmapKind::kBack;
  front.closed = true;
  EXPECT_EQ(redundant(), (std::set<int>{4}));
}

TEST(WithoutKeyframes, FramesStayWhereTheMapHasThem) {
  Submap all = make_submap({7, -1}, 3, 12);
  const Placement placement = make_placement(all, 5);
  std::set<int> some;
  for (const auto& [id, keyframe] : all.keyframes)
    if (id % 3 != 0) some.insert(id);
  const Submap left = without_keyframes(all, placement, some);
  EXPECT_EQ(left.revision, all.revision + 1);
  EXPECT_EQ(left.keyframes.size(), all.keyframes.size() - some.size());
  ASSERT_EQ(left.frames.size(), all.frames.size());
  for (const auto& [utime_us, frame] : all.frames) {
    const FramePose& now = left.frames.at(utime_us);
    ASSERT_TRUE(left.keyframe(now.reference_keyframe));
    const SE3 was_there = placement.cam_from_map(all, frame), is_there = placement.cam_from_map(left, now);
    EXPECT_LT((was_there.center() - is_there.center()).norm(), 1e-9);
    EXPECT_LT(was_there.rotation.angularDistance(is_there.rotation), 1e-7);
  }
  for (const auto& [id, landmark] : left.landmarks) {
    if (landmark.observations.size() != all.landmarks.at(id).observations.size()) {
      EXPECT_GE(landmark.observations.size(), 2u);
    }
    for (const Observation& o : landmark.observations)
      EXPECT_EQ(left.keyframe(o.keyframe_id)->landmark_ids[o.keypoint_index], id);
  }
  EXPECT_LT(left.landmarks.size(), all.landmarks.size());
  // Those who have the previous revision receive the removals.
  Atlas atlas;
  update_atlas(&atlas, all);
  update_atlas(&atlas, left);
  const Submap& copy = atlas.find(all.key)->submap;
  EXPECT_EQ(copy.keyframes.size(), left.keyframes.size());
  EXPECT_EQ(copy.landmarks.size(), left.landmarks.size());
  for (const auto& [utime_us, frame] : left.frames)
    EXPECT_LT((copy.cam_from_submap(copy.frames.at(utime_us)).center() - left.cam_from_submap(frame).center()).norm(),
              1e-12);

  std::set<int> every;
  for (const auto& [id, keyframe] : all.keyframes) every.insert(id);
  EXPECT_EQ(without_keyframes(all, placement, every).revision, all.revision);
}

}  // namespace
}  // namespace rumi::testing
