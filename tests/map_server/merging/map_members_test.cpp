// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_members.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rumi::map_server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class MapMembersTest : public ::testing::Test {
 protected:
  // Adds a submap with this many frames, which no other submap has.
  SubmapKey add(SubmapKey key, int frames) {
    Submap& submap = made_[key];
    submap.key = key;
    submap.kind = key.id < 0 ? SubmapKind::kBack : SubmapKind::kFront;
    for (int i = 0; i < frames; ++i) submap.frames.set({++last_us_, kNone, {}});
    input_.submaps[key] = &submap;
    return key;
  }
  void join(SubmapKey a, SubmapKey b) {
    LinkEdge edge;
    edge.link = {.a = a, .b = b};
    graph_.places.found.push_back(edge);
  }
  std::set<SubmapKey> members() const { return choose_members(graph_, input_); }

  std::map<SubmapKey, Submap> made_;
  int64_t last_us_ = 0;
  LinkGraph graph_;
  BuildInput input_;
};

TEST_F(MapMembersTest, TheGroupWithMostFramesIsTheMap) {
  EXPECT_THAT(members(), IsEmpty());
  const SubmapKey a = add({1, 1}, 30), b = add({1, 2}, 20), c = add({1, 3}, 20);
  EXPECT_THAT(members(), ElementsAre(a));
  join(b, c);
  EXPECT_THAT(members(), ElementsAre(b, c));
  graph_.tied_before = {{a, b}};
  EXPECT_THAT(members(), ElementsAre(a, b, c));
}

TEST_F(MapMembersTest, OfEqualsThatWithAFrontSubmap) {
  add({1, -1}, 20);
  const SubmapKey front = add({1, 1}, 20);
  add({1, -2}, 20);
  EXPECT_THAT(members(), ElementsAre(front));
}

TEST_F(MapMembersTest, AnImageOfTwoSubmapsCountsOnce) {
  const SubmapKey a = add({1, 1}, 20), b = add({1, 2}, 0), c = add({1, 3}, 30);
  made_[b].frames = made_[a].frames;
  join(a, b);
  EXPECT_THAT(members(), ElementsAre(c));
}

TEST_F(MapMembersTest, FramesOfPreferredSessionsComeFirst) {
  add({1, 1}, 100);
  const SubmapKey now = add({2, 1}, 5);
  input_.present = {2};
  EXPECT_THAT(members(), ElementsAre(now));
}

TEST_F(MapMembersTest, WhatIsFixedIsOneGroupAndTheMap) {
  add({1, 1}, 100);
  const SubmapKey a = add({2, 1}, 5), b = add({2, 2}, 5), c = add({2, 3}, 5);
  input_.fixed = {a, b};
  EXPECT_THAT(members(), ElementsAre(a, b));
  join(c, b);
  EXPECT_THAT(members(), ElementsAre(a, b, c));
}

TEST_F(MapMembersTest, WhatIsNotHereStillTiesWhatHangsOnIt) {
  const SubmapKey a = add({1, 1}, 20), away{1, 2}, c = add({1, 3}, 20);
  join(a, away);
  join(away, c);
  EXPECT_THAT(members(), ElementsAre(a, c));
}

}  // namespace
}  // namespace rumi::map_server
