// SPDX-License-Identifier: BSD-3-Clause
// Wrong links: which ones are removed from a map, and which submaps remain in it.
#include "map_server/merging/arrangement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/map_server/merging/map_builder_fixture.h"

namespace rumi::testing {
namespace {

using ArrangementTest = MapBuilderTest;

TEST_F(ArrangementTest, ARefusedLinkIsToldAndJoinsNothing) {
  recipes_[back1_].rotation_noise_deg = 10;
  recipes_[back1_].center_noise_m = 0.5;
  recipes_[back1_].wrong_landmarks = 1;
  made_[back1_] = make_submap(world_, images_, recipes_[back1_]);
  MapMaker maker;
  maker.find({.submaps = submaps()});
  int refused = 0;
  for (const Link& link : maker.graph().links()) refused += link.kind == Link::Kind::kSameImages && !link.accepted();
  EXPECT_EQ(refused, 2);
  const BuiltMap map = maker.build({.submaps = submaps()});
  print("without a back submap", map, error(map.placements));
  EXPECT_FALSE(map.placements.contains(back1_));
  EXPECT_TRUE(map.placements.contains(front3_));
  EXPECT_LT(error(map.placements).rmse, 0.04);
}

// Each part of the torn submap fits the submap beside it, but the two parts do not fit each other.
TEST_F(ArrangementTest, ATornSubmapIsNotJoinedByLikenessEither) {
  recipes_[back1_].distortion = jump(33, Sim3(1.5, so3_exp({0, 0.3, 0}), {0.5, 0, 0}));
  made_[back1_] = make_submap(world_, images_, recipes_[back1_]);
  MapMaker maker;
  maker.find({.submaps = submaps()});
  for (const Link& link : maker.graph().links())
    if (link.accepted()) {
      EXPECT_NE(std::minmax(link.a, link.b), std::minmax(front1_, back1_));
    }
  EXPECT_FALSE(maker.build({.submaps = submaps()}).placements.contains(front1_));
}

// The front submap jumps half way, where no other submap sees it, so everything seems to fit for the back submap at its
// end. Another back submap overlaps with its beginning too.
TEST_F(ArrangementTest, ALinkThatTheRestContradictsIsTakenOut) {
  recipes_[front1_].distortion = jump(18, Sim3(1.4, so3_exp({0, 0.2, 0}), {0.3, 0, 0}));
  made_[front1_] = make_submap(world_, images_, recipes_[front1_]);
  add({kSession, -3}, 0, 69, 0);
  const auto doubt = [](const MapMaker& maker, SubmapKey a, SubmapKey b) {
    for (const Link& link : maker.graph().links())
      if (link.kind == Link::Kind::kSameImages && std::minmax(link.a, link.b) == std::minmax(a, b)) return link.doubt;
    return std::string("no link");
  };
  MapMaker maker;
  maker.find({.submaps = submaps()});
  EXPECT_EQ(doubt(maker, front1_, back1_), "");
  EXPECT_EQ(doubt(maker, front1_, {kSession, -3}), "") << "its beginning is right";
  const BuiltMap map = maker.build({.submaps = submaps()});
  print("one link wrong", map, error(map.placements));
  EXPECT_NE(doubt(maker, front1_, back1_).find("contradicts"), std::string::npos) << doubt(maker, front1_, back1_);
  EXPECT_EQ(map.placements.size(), 6u);
  EXPECT_LT(error(map.placements).rmse, 0.04);

  MapBuilderOptions trusting;
  trusting.arrangement.graph.max_joint_chi2 = 1e9;
  MapMaker other(trusting);
  const BuiltMap wrong = other.build({.submaps = submaps()});
  print("the same, believed", wrong, error(wrong.placements));
  EXPECT_EQ(doubt(other, front1_, back1_), "");
}

// A wrong link was accepted, and the map served. Later evidence contradicts it, and the submap that only this link had
// joined leaves the map.
TEST_F(ArrangementTest, AWrongMergeThatWasServedComesApart) {
  recipes_[front1_].distortion = jump(18, Sim3(1.4, so3_exp({0, 0.2, 0}), {0.3, 0, 0}));
  made_[front1_] = make_submap(world_, images_, recipes_[front1_]);
  MapMaker maker;
  const Placements served = maker.build({.submaps = submaps()}).placements;
  ASSERT_TRUE(served.contains(front1_)) << "to the back submap of its end all seems to fit";

  // A new revision of front1 no longer fits the other submaps.
  made_[front1_].submap.revision = 2;
  SubmapRecipe torn = recipes_[front1_];
  torn.distortion = jump(0, Sim3());
  torn.rotation_noise_deg = 10;
  torn.center_noise_m = 0.5;
  made_[front1_] = make_submap(world_, images_, torn);
  made_[front1_].submap.revision = 2;
  for (auto& [id, keyframe] : made_[front1_].submap.keyframes) keyframe.revision = 2;
  const BuiltMap map = maker.build({.submaps = submaps(), .placed = served});
  print("apart again", map, error(map.placements));
  EXPECT_EQ(map.placements.size(), 4u);
  EXPECT_FALSE(map.placements.contains(front1_));
  EXPECT_FALSE(map.unmoved.contains(front1_));
}

// The scale of front2 slips within the images that it shares with the only submap before it. So the joints there
// contradict each other, but no other edge does.
TEST_F(ArrangementTest, AnOnlyTieHoldsWhereItAgreesBest) {
  recipes_[front2_].distortion = jump(58, Sim3(1.06, so3_exp({0, 0.06, 0}), {0.06, 0, 0}));
  made_[front2_] = make_submap(world_, images_, recipes_[front2_]);
  MapBuilderOptions strict;
  strict.arrangement.graph.max_joint_chi2 = 0.01;
  MapMaker maker(strict);
  const BuiltMap map = maker.build({.submaps = submaps()});
  print("only ties", map, error(map.placements));
  EXPECT_EQ(map.placements.size(), 5u);
  EXPECT_LT(error(map.placements).rmse, 0.04);
  for (const Link& link : maker.graph().links()) EXPECT_EQ(link.doubt, "") << link.a.id << " and " << link.b.id;
}

}  // namespace
}  // namespace rumi::testing
