// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/links/link_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>

namespace rumi::map_server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

SubmapKey key(int id) { return {1, id}; }

KeyframeJoint joint(int a, int b, int keyframe) { return {{key(a), keyframe}, {key(b), keyframe}, {}}; }

LinkEdge edge(int a, int b, int inliers, const std::string& doubt = "") {
  LinkEdge edge;
  edge.link = {.a = key(a), .b = key(b), .landmark_inliers = inliers, .doubt = doubt};
  if (doubt.empty()) edge.joints = {joint(a, b, 1), joint(a, b, 2)};
  return edge;
}

class LinkGraphTest : public ::testing::Test {
 protected:
  const LinkEdge* by_images(int a, int b, int inliers, const std::string& doubt = "") {
    ComparedPair& pair = graph_.compared[{key(a), key(b)}];
    pair = {.revision_a = 1, .revision_b = 1, .edge = edge(a, b, inliers, doubt)};
    return &*pair.edge;
  }
  // Adds the only edge of these two submaps to places.found.
  void by_appearance(int a, int b, int inliers) {
    graph_.places.found.push_back(edge(a, b, inliers));
    graph_.places.found.back().link.kind = Link::Kind::kAppearance;
  }
  bool hang_together(int a, int b) const {
    Groups groups = graph_.groups();
    return groups.find(key(a)) == groups.find(key(b));
  }
  std::vector<SubmapPair> order(std::set<SubmapKey> placed, std::initializer_list<int> members) const {
    std::set<SubmapKey> keys;
    for (int id : members) keys.insert(key(id));
    std::vector<SubmapPair> order;
    for (const LinkEdge* edge : graph_.placing_order(std::move(placed), keys))
      order.emplace_back(edge->link.a, edge->link.b);
    return order;
  }
  Submaps submaps(std::initializer_list<int> ids) const {
    Submaps submaps;
    for (int id : ids) submaps[key(id)] = &submap_;
    return submaps;
  }

  Submap submap_;
  LinkGraph graph_;
};

TEST_F(LinkGraphTest, AcceptedEdgesOfBothKindsHoldSubmapsTogether) {
  by_images(1, 2, 50);
  by_images(2, 3, 50, "no");
  by_appearance(4, 3, 50);
  EXPECT_TRUE(hang_together(1, 2));
  EXPECT_TRUE(hang_together(3, 4));
  EXPECT_FALSE(hang_together(2, 3));
  EXPECT_EQ(graph_.edges().size(), 2u);
}

TEST_F(LinkGraphTest, WhatIsInheritedHoldsThemTogetherButIsNoEdge) {
  graph_.tied_before = {{key(1), key(2)}};
  EXPECT_TRUE(hang_together(1, 2));
  Groups tied = graph_.tied();
  EXPECT_NE(tied.find(key(1)), tied.find(key(2)));
  EXPECT_THAT(graph_.edges(), IsEmpty());
}

TEST_F(LinkGraphTest, TheEdgeWithMostInliersIsPlacedFirst) {
  by_images(1, 2, 50);
  by_images(1, 3, 70);
  by_images(2, 3, 90);
  by_images(3, 4, 60);
  EXPECT_THAT(order({key(1)}, {1, 2, 3, 4}),
              ElementsAre(SubmapPair(key(1), key(3)), SubmapPair(key(2), key(3)), SubmapPair(key(3), key(4))));
  EXPECT_THAT(order({key(1)}, {1, 2, 4}), ElementsAre(SubmapPair(key(1), key(2))));
  EXPECT_THAT(order({key(1), key(2)}, {1, 2}), IsEmpty());
}

TEST_F(LinkGraphTest, AnEdgeIsTheOnlyOneWhereNoOtherWayIsHere) {
  const LinkEdge* direct = by_images(1, 2, 50);
  EXPECT_TRUE(graph_.is_only(*direct, submaps({1, 2})));
  by_images(1, 3, 50);
  by_appearance(3, 2, 50);
  EXPECT_FALSE(graph_.is_only(*direct, submaps({1, 2, 3})));
  EXPECT_TRUE(graph_.is_only(*direct, submaps({1, 2})));
}

TEST_F(LinkGraphTest, TellsTheBestLinkOfEachTwoAndOfEachKind) {
  by_images(1, 2, 50, "no");
  by_appearance(1, 2, 30);
  by_appearance(2, 1, 40);
  graph_.places.refused[{key(1), key(2)}] = edge(1, 2, 90, "of before").link;
  graph_.places.refused[{key(1), key(3)}] = edge(1, 3, 90, "never").link;
  std::vector<std::pair<int, std::string>> told;
  for (const Link& link : graph_.links()) told.emplace_back(link.landmark_inliers, link.doubt);
  EXPECT_THAT(told, ElementsAre(std::pair(50, "no"), std::pair(40, ""), std::pair(90, "never")));
}

TEST_F(LinkGraphTest, WhatTurnsOutToBeWrongIsToldAsRefused) {
  const LinkEdge* wrong = by_images(1, 2, 50);
  by_images(1, 3, 50);
  for (const int inliers : {20, 30, 40, 60}) by_appearance(2, 3, inliers);
  const std::vector<LinkEdge>& found = graph_.places.found;
  graph_.refuse({{wrong, "torn"}, {&found[0], "first"}, {&found[2], "third"}});
  EXPECT_EQ(wrong->link.doubt, "torn");
  EXPECT_THAT(wrong->joints, IsEmpty());
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].link.landmark_inliers, 30);
  EXPECT_EQ(found[1].link.landmark_inliers, 60);
  EXPECT_EQ(graph_.places.refused.at({key(2), key(3)}).doubt, "first");
  EXPECT_EQ(graph_.edges().size(), 3u);
}

TEST_F(LinkGraphTest, LosesSingleJoints) {
  const LinkEdge* edge = by_images(1, 2, 50);
  graph_.forget_joints(*edge, {name_of(joint(1, 2, 1))});
  ASSERT_EQ(edge->joints.size(), 1u);
  EXPECT_EQ(edge->joints[0].a.id, 2);
}

TEST_F(LinkGraphTest, ARevisionThatChangesNothingIsTakenAsCompared) {
  by_images(1, 2, 50);
  by_images(2, 3, 50);
  graph_.compared[{key(2), key(3)}].revision_a = 0;  // as if compared with an earlier revision
  graph_.take_as_compared(key(2), 2);
  EXPECT_EQ((graph_.compared[{key(1), key(2)}].revision_b), 2);
  EXPECT_EQ((graph_.compared[{key(1), key(2)}].revision_a), 1);
  EXPECT_EQ((graph_.compared[{key(2), key(3)}].revision_a), 0);
}

TEST_F(LinkGraphTest, ImagesAreJoinedWhicheverComesFirst) {
  const ImageId a{1, 7}, b{2, 7};
  graph_.built.similar = {{a, b}};
  EXPECT_TRUE(graph_.are_joined(a, b));
  EXPECT_TRUE(graph_.are_joined(b, a));
  EXPECT_FALSE(graph_.are_joined(a, a));
}

TEST_F(LinkGraphTest, SubmapsTouchByEdgesAndByPointsOfTheBuiltMap) {
  by_appearance(4, 3, 50);
  graph_.built.touching.insert({key(1), key(2)});
  EXPECT_THAT(graph_.contacts(), UnorderedElementsAre(SubmapPair(key(1), key(2)), SubmapPair(key(3), key(4))));
}

TEST_F(LinkGraphTest, TheEdgeOfTwoIsFoundFromEitherSide) {
  const LinkEdge* edge = by_images(1, 2, 50, "no");
  graph_.compared[{key(1), key(3)}] = {.revision_a = 1, .revision_b = 1, .edge = std::nullopt};
  EXPECT_EQ(graph_.edge_between(key(1), key(2)), edge);
  EXPECT_EQ(graph_.edge_between(key(2), key(1)), edge);
  EXPECT_EQ(graph_.edge_between(key(1), key(3)), nullptr);
  EXPECT_EQ(graph_.edge_between(key(2), key(3)), nullptr);
}

}  // namespace
}  // namespace rumi::map_server
