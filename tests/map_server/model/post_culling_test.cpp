// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/post_culling.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/map_server/merging/map_maker.h"
#include "tests/map_server/synthetic_chain.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

constexpr SubmapKey kFront1 = Chain::kFront1, kBack1 = Chain::kBack1, kBack2 = Chain::kBack2;

// One back submap of five images; each sees the same points, one keypoint each, in octave 2.
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
    EXPECT_TRUE(sets.empty() || (sets.size() == 1 && sets.contains(back_)));
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
  // Of two back submaps, not both.
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
  // Whoever has the submap as it was learns of it.
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

class PostCullingTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { chain_ = new Chain; }
  static void TearDownTestSuite() { delete chain_; }
  PostCullingTest() {
    for (const SubmapKey key : {kFront1, kBack1, Chain::kFront2, kBack2, Chain::kFront3})
      put(chain_->submap(key), &atlas_);
  }
  Submaps submaps() const {
    Submaps submaps;
    for (const auto& [key, owner] : atlas_.submaps()) submaps[key] = &owner.submap;
    return submaps;
  }
  BuiltMap build(MapMaker* maker) {
    Placements placed;
    for (const auto& [key, owner] : atlas_.submaps())
      if (owner.placement.revision > 0) placed[key] = owner.placement;
    BuiltMap built = maker->build({.submaps = submaps(), .placed = placed});
    for (const auto& [key, submap] : built.culled) put(*submap, &atlas_);
    atlas_.place_map(built.placements);
    return built;
  }
  size_t keyframes(SubmapKey key) const { return atlas_.find(key)->submap.keyframes.size(); }

  static Chain* chain_;
  Atlas atlas_;
};
Chain* PostCullingTest::chain_ = nullptr;

TEST_F(PostCullingTest, BackSubmapsLoseWhatTheMapCanDoWithout) {
  MapBuilderOptions without;
  without.culling.enabled = false;
  MapMaker uncut(without), culling;
  Atlas whole = atlas_;
  const BuiltMap expected = uncut.build({.submaps = submaps()});
  EXPECT_TRUE(expected.culled.empty());
  whole.place_map(expected.placements);

  const BuiltMap built = build(&culling);
  EXPECT_EQ(built.culled.size(), 2u);
  for (const SubmapKey key : {kBack1, kBack2}) {
    EXPECT_LT(keyframes(key), whole.find(key)->submap.keyframes.size());
    EXPECT_EQ(built.placements.at(key).map_from_submap.size(), keyframes(key));
    for (const auto& [id, position] : built.placements.at(key).landmarks)
      EXPECT_TRUE(atlas_.find(key)->submap.landmark(id));
  }
  std::printf("%zu and %zu of %zu and %zu keyframes are left\n", keyframes(kBack1), keyframes(kBack2),
              whole.find(kBack1)->submap.keyframes.size(), whole.find(kBack2)->submap.keyframes.size());
  for (const auto& [key, placement] : built.placements)
    for (const auto& [id, into] : placement.fused)
      EXPECT_TRUE(atlas_.find(into.submap)->submap.landmark(into.id)) << "fused into what is gone";
  // Nobody sees a frame move.
  const auto was = whole.map_trajectory(), is = atlas_.map_trajectory();
  ASSERT_EQ(is.size(), size_t{Chain::kImages});
  for (const auto& [image, map_from_cam] : was)
    EXPECT_LT((is.at(image).translation - map_from_cam.translation).norm(), 1e-8);
}

TEST_F(PostCullingTest, TheMapCanBeBuiltAgainOfWhatIsLeft) {
  MapMaker maker;
  build(&maker);
  const size_t left = keyframes(kBack1) + keyframes(kBack2);
  const BuiltMap again = build(&maker);
  EXPECT_LT(chain_->error(atlas_).rmse, 0.04);
  std::printf("%zu keyframes left at first, %zu then\n", left, keyframes(kBack1) + keyframes(kBack2));

  MapMaker fresh;  // after a restart
  fresh.find({.submaps = submaps()});
  int accepted = 0;
  for (const Link& link : fresh.graph().links()) accepted += link.accepted() && link.kind == Link::Kind::kSameImages;
  EXPECT_EQ(accepted, 4);
  const BuiltMap anew = fresh.build({.submaps = submaps()});
  EXPECT_EQ(anew.placements.size(), 5u);
  atlas_.place_map(anew.placements);
  const PathError error = chain_->error(atlas_);
  std::printf("anew: ATE %.1f mm, worst %.1f mm\n", 1000 * error.rmse, 1000 * error.worst);
  EXPECT_LT(error.rmse, 0.04);
  EXPECT_LT(error.worst, 0.1);
}

TEST_F(PostCullingTest, WhatWasRefusedKeepsAllImages) {
  Atlas spoiled;
  for (const auto& [key, owner] : atlas_.submaps())
    put(key == kFront1 ? chain_->spoiled(kFront1) : owner.submap, &spoiled);
  atlas_ = spoiled;
  MapMaker maker;
  const BuiltMap built = build(&maker);
  ASSERT_FALSE(built.placements.contains(kFront1));
  ASSERT_TRUE(built.culled.contains(kBack1));
  const auto at_times_of = [](const Submap& front, const Submap& back) {
    std::set<int64_t> times;
    for (const auto& [id, keyframe] : front.keyframes) times.insert(keyframe.utime_us);
    return std::count_if(back.keyframes.begin(), back.keyframes.end(),
                         [&](const auto& item) { return times.contains(item.second.utime_us); });
  };
  const Submap& front = atlas_.find(kFront1)->submap;
  EXPECT_GT(at_times_of(front, chain_->submap(kBack1)), 4);
  EXPECT_EQ(at_times_of(front, *built.culled.at(kBack1)), at_times_of(front, chain_->submap(kBack1)));
}

}  // namespace
}  // namespace rumi::testing
