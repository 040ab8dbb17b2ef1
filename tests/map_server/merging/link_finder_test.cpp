// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/link_finder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "tests/map_server/synthetic_chain.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class LinkFinderTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { chain_ = new Chain; }
  static void TearDownTestSuite() { delete chain_; }

  BuildInput input(const std::vector<SubmapKey>& keys, BuildScope scope = BuildScope::kWeld) const {
    BuildInput input{.submaps = {}, .scope = scope};
    for (const SubmapKey& key : keys) input.submaps[key] = &chain_->submap(key);
    return input;
  }
  const std::vector<SubmapKey> all_{Chain::kFront1, Chain::kBack1, Chain::kFront2, Chain::kBack2, Chain::kFront3};

  static Chain* chain_;
};
Chain* LinkFinderTest::chain_ = nullptr;

TEST_F(LinkFinderTest, FindsWhatHangsTogether) {
  const LinkGraph graph = LinkFinder({}).find({}, input(all_));
  for (size_t i = 1; i < all_.size(); ++i) {
    const LinkEdge* edge = graph.edge_between(all_[i - 1], all_[i]);
    ASSERT_TRUE(edge);
    EXPECT_TRUE(edge->link.accepted()) << edge->link.doubt;
    EXPECT_FALSE(edge->joints.empty());
  }
  EXPECT_EQ(graph.edge_between(Chain::kFront1, Chain::kFront3), nullptr);
}

TEST_F(LinkFinderTest, LooksOnlyAtWhatHasChanged) {
  LinkFinder finder({});
  BuildInput two = input({Chain::kFront1, Chain::kBack1});
  LinkGraph graph = finder.find({}, two);
  LinkEdge& edge = *graph.compared.begin()->second.edge;
  const Link before = edge.link;
  edge.link.doubt = "marked";
  graph = finder.find(graph, two);
  EXPECT_EQ(graph.edge_between(Chain::kFront1, Chain::kBack1)->link.doubt, "marked");
  Submap changed = chain_->submap(Chain::kBack1);
  ++changed.revision;
  two.submaps[changed.key] = &changed;
  graph = finder.find(graph, two);
  EXPECT_EQ(graph.edge_between(Chain::kFront1, Chain::kBack1)->link, before);
}

TEST_F(LinkFinderTest, APairThatFitsIsComparedAgainOnlyWhereWhatItSharesHasChanged) {
  LinkFinder finder({});
  BuildInput two = input({Chain::kFront1, Chain::kBack1});
  LinkGraph graph = finder.find({}, two);
  LinkEdge& edge = *graph.compared.begin()->second.edge;
  ASSERT_TRUE(edge.link.accepted());
  edge.link.rmse_px = 99;  // a mark
  Submap grown = chain_->submap(Chain::kFront1);
  const Submap& other = chain_->submap(Chain::kBack1);
  two.submaps[grown.key] = &grown;
  const auto mark = [&] { return graph.edge_between(Chain::kFront1, Chain::kBack1)->link.rmse_px; };
  grown.keyframes.begin()->second.revision = ++grown.revision;
  ASSERT_FALSE(other.frame(grown.keyframes.begin()->second.utime_us)) << "only this submap has its first keyframe";
  graph = finder.find(graph, two);
  EXPECT_EQ(mark(), 99);
  const auto shared = std::find_if(grown.keyframes.begin(), grown.keyframes.end(),
                                   [&](const auto& item) { return other.frame(item.second.utime_us) != nullptr; });
  ASSERT_NE(shared, grown.keyframes.end());
  shared->second.revision = ++grown.revision;
  graph = finder.find(graph, two);
  EXPECT_LT(mark(), 99);
}

// A new keyframe of the map is searched for once its landmarks are known well; one outside the map at once.
TEST_F(LinkFinderTest, NewKeyframesOfTheMapWaitUntilTheyAreSettled) {
  const auto newest_us = [this](SubmapKey key) { return chain_->submap(key).frames.rbegin()->first; };
  const SubmapKey key = Chain::kFront1;
  LinkFinderOptions options;
  options.places.settled_s = 1e-6 * static_cast<double>(newest_us(key) - chain_->submap(key).frames.begin()->first) / 2;
  const auto known = [&](const LinkGraph& graph) { return graph.places.known.size(); };
  const size_t all = chain_->submap(key).keyframes.size();
  EXPECT_EQ(known(LinkFinder(options).find({}, input({key}))), all) << "it is not in the map";
  LinkGraph in_map;
  in_map.built.submaps = {key};
  const size_t settled = known(LinkFinder(options).find(in_map, input({key})));
  EXPECT_GT(settled, 0U);
  EXPECT_LT(settled, all);
  EXPECT_EQ(known(LinkFinder(options).find(in_map, input({key}, BuildScope::kAll))), all);
}

TEST_F(LinkFinderTest, WhatIsFixedIsNotCompared) {
  BuildInput three = input({Chain::kFront1, Chain::kBack1, Chain::kFront2});
  three.fixed = {Chain::kFront1, Chain::kBack1};
  const LinkGraph graph = LinkFinder({}).find({}, three);
  EXPECT_EQ(graph.edge_between(Chain::kFront1, Chain::kBack1), nullptr);
  EXPECT_TRUE(graph.edge_between(Chain::kBack1, Chain::kFront2));
}

TEST_F(LinkFinderTest, InheritsOnceWhatItsEdgesDoNotJoin) {
  LinkFinder finder({});
  BuildInput three = input({Chain::kFront1, Chain::kFront2, Chain::kFront3});
  for (const auto& [key, submap] : three.submaps) three.placed[key] = {};
  LinkGraph graph = finder.find({}, three);
  EXPECT_THAT(graph.tied_before,
              ElementsAre(SubmapPair(Chain::kFront1, Chain::kFront2), SubmapPair(Chain::kFront1, Chain::kFront3)));
  BuildInput more = input({Chain::kFront1, Chain::kBack1, Chain::kFront2, Chain::kFront3});
  more.placed = three.placed;
  graph = finder.find(graph, more);
  EXPECT_THAT(graph.tied_before, ElementsAre(SubmapPair(Chain::kFront1, Chain::kFront3)));
  LinkGraph other = finder.find(finder.find({}, input({Chain::kFront1})), three);
  EXPECT_THAT(other.tied_before, IsEmpty()) << "it has begun without a map";
}

TEST_F(LinkFinderTest, OutsideAWeldWhatIsBesideTheMapIsSearchedForOnceMore) {
  const std::vector<SubmapKey> apart{Chain::kFront1, Chain::kBack2};
  const BuildInput weld = input(apart), all = input(apart, BuildScope::kAll);
  LinkFinder finder({});
  LinkGraph graph = finder.find({}, weld);
  EXPECT_THAT(graph.places.searched_again, IsEmpty());
  graph = finder.find(graph, all);
  EXPECT_EQ(graph.places.searched_again.size(), 1u);
}

TEST_F(LinkFinderTest, ACancelledSearchEndsSoon) {
  const std::atomic<bool> cancel = true;
  BuildInput cancelled = input(all_);
  cancelled.cancel = &cancel;
  EXPECT_THAT(LinkFinder({}).find({}, cancelled).links(), IsEmpty());
}

}  // namespace
}  // namespace rumi::testing
