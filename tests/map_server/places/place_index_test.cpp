// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_index.h"

#include <gtest/gtest.h>

#include "tests/map_server/places/place_scene.h"

namespace rumi::map_server {
namespace {

// Three submaps with the same nine keyframe ids: the first two of different rooms, the third of the first room again.
class PlaceIndexTest : public ::testing::Test {
 protected:
  PlaceIndexTest() {
    PlaceScene scene(1);
    const auto room = scene.cloud(400), other = scene.cloud(400);
    submaps_.push_back(scene.submap({1, 1}, room, scene.path(0, 0, 0), Sim3()));
    submaps_.push_back(scene.submap({1, 2}, other, scene.path(0, 0, 0), Sim3()));
    submaps_.push_back(scene.submap({2, 1}, room, scene.path(0.2, 0, 0.1), scene.gauge(2)));
    for (const Submap& s : submaps_)
      for (const auto& [id, keyframe] : s.keyframes) index_.add(s, keyframe);
  }
  std::vector<PlaceCandidate> query(const Submap& s, int keyframe, size_t count, int64_t separation_us = 0,
                                    int64_t apart_us = 0) const {
    return index_.query(landmark_descriptors(*s.keyframe(keyframe)), count, separation_us,
                        exclude_surroundings(s, keyframe, apart_us));
  }
  std::vector<Submap> submaps_;
  PlaceIndex index_;
};

TEST_F(PlaceIndexTest, FindsThePlaceInAnotherSubmap) {
  EXPECT_EQ(index_.size(), 27u);
  for (int keyframe = 1; keyframe <= 9; ++keyframe) {
    const auto found = query(submaps_[0], keyframe, 9);
    ASSERT_EQ(found.size(), 9u);
    for (const PlaceCandidate& c : found) EXPECT_EQ(c.place.submap, submaps_[2].key);
    for (size_t i = 1; i < found.size(); ++i) EXPECT_LE(found[i].score, found[i - 1].score);
    EXPECT_EQ(found[0].place.image.utime_us, 1'000'000 * found[0].place.keyframe);
  }
}

TEST_F(PlaceIndexTest, ExcludesItselfAndItsSurroundings) {
  for (const PlaceCandidate& c : query(submaps_[0], 5, 100)) EXPECT_NE(c.place.submap, submaps_[0].key);
  // Without common landmarks, only keyframes near in time are excluded.
  Submap alone = submaps_[0];
  alone.landmarks.clear();
  for (auto& [id, keyframe] : alone.keyframes) keyframe.landmark_ids.assign(keyframe.landmark_ids.size(), kNone);
  const auto exclude = exclude_surroundings(alone, 5, 2'000'000);
  EXPECT_TRUE(exclude({alone.key, 5, 5'000'000}));
  EXPECT_TRUE(exclude({alone.key, 4, 4'000'000}));
  EXPECT_FALSE(exclude({alone.key, 3, 3'000'000}));
  EXPECT_FALSE(exclude({{1, 2}, 5, 5'000'000}));
  // If nothing is excluded, the keyframe itself comes first.
  const auto all = index_.query(landmark_descriptors(*submaps_[0].keyframe(5)), 3, 0, nullptr);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].place, (Place{submaps_[0].key, 5, 5'000'000}));
}

TEST_F(PlaceIndexTest, WhatIsRemovedIsNotFound) {
  index_.remove_if([](const Place& place) { return place.keyframe > 3; });
  EXPECT_EQ(index_.size(), 9u);
  const auto found = query(submaps_[0], 5, 9);
  ASSERT_GE(found.size(), 3u);
  EXPECT_EQ(found[0].place.submap, submaps_[2].key);
  for (const PlaceCandidate& c : found) EXPECT_LE(c.place.keyframe, 3);
}

TEST_F(PlaceIndexTest, OfNeighboursOnlyTheBest) {
  const auto found = query(submaps_[0], 5, 100, 3'000'000);
  std::map<SubmapKey, std::vector<int64_t>> times;
  for (const PlaceCandidate& c : found) times[c.place.submap].push_back(c.place.image.utime_us);
  for (const auto& [key, of] : times)
    for (size_t i = 0; i < of.size(); ++i)
      for (size_t j = 0; j < i; ++j) EXPECT_GE(std::abs(of[i] - of[j]), 3'000'000);
  EXPECT_EQ(found[0].place, query(submaps_[0], 5, 1)[0].place);
  EXPECT_GE(times[submaps_[2].key].size(), 2u);
}

TEST_F(PlaceIndexTest, RemovesAndReplaces) {
  const Place best = query(submaps_[0], 5, 1)[0].place;
  index_.remove(best.submap, best.keyframe);
  EXPECT_FALSE(index_.contains(best.submap, best.keyframe));
  EXPECT_NE(query(submaps_[0], 5, 1)[0].place, best);
  index_.remove(best.submap, best.keyframe);  // removing it twice has no effect
  EXPECT_EQ(index_.size(), 26u);

  const Keyframe& keyframe = *submaps_[2].keyframe(best.keyframe);
  index_.add(submaps_[2], keyframe);
  const double score = query(submaps_[0], 5, 1)[0].score;
  index_.add(submaps_[2], keyframe);  // adding it again does not double it
  EXPECT_EQ(index_.size(), 27u);
  EXPECT_EQ(query(submaps_[0], 5, 1)[0].place, best);
  EXPECT_EQ(query(submaps_[0], 5, 1)[0].score, score);
}

TEST_F(PlaceIndexTest, NothingInNothingOut) {
  EXPECT_TRUE(index_.query({}, 5, 0, nullptr).empty());
  EXPECT_TRUE(query(submaps_[0], 5, 0).empty());
  EXPECT_TRUE(PlaceIndex().query({Descriptor{}}, 5, 0, nullptr).empty());
  PlaceIndex empty;
  empty.add(Submap(), Keyframe());  // a keyframe without features
  EXPECT_EQ(empty.size(), 1u);
  EXPECT_TRUE(empty.query(landmark_descriptors(*submaps_[0].keyframe(5)), 5, 0, nullptr).empty());
}

TEST_F(PlaceIndexTest, IsTheSameEveryTime) {
  PlaceIndex again;
  for (const Submap& s : submaps_)
    for (const auto& [id, keyframe] : s.keyframes) again.add(s, keyframe);
  const auto descriptors = landmark_descriptors(*submaps_[1].keyframe(3));
  const auto one = index_.query(descriptors, 27, 0, nullptr), two = again.query(descriptors, 27, 0, nullptr);
  ASSERT_EQ(one.size(), two.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].place, two[i].place);
    EXPECT_EQ(one[i].score, two[i].score);
  }
}

}  // namespace
}  // namespace rumi::map_server
