// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_search.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>

#include "tests/map_server/places/place_scene.h"

namespace rumi::map_server {
namespace {

const SubmapKey kFront{1, 1}, kBack{1, -1}, kLater{1, 2};
constexpr int64_t kLaterUs = 100'000'000;

// Two submaps of the same images, and a third one that sees the place later.
class PlaceSearchTest : public ::testing::Test {
 protected:
  PlaceSearchTest() : scene_(3), points_(scene_.cloud(700)) {
    front_ = scene_.submap(kFront, points_, scene_.path(0, 0, 0), scene_.gauge(1));
    back_ = scene_.submap(kBack, points_, scene_.path(0, 0, 0), scene_.gauge(2));
    later_ = scene_.submap(kLater, points_, scene_.path(0.5, 0.1, 0.2, -0.1), scene_.gauge(0.7));
    later_.frames = {};
    for (auto& [id, keyframe] : later_.keyframes) keyframe.utime_us += kLaterUs;
    for (Submap* submap : {&front_, &back_, &later_})
      for (const auto& [id, keyframe] : submap->keyframes) submap->frames.set({keyframe.utime_us, id, {}, 1});
  }

  std::map<SubmapKey, int> links_of(const PlaceLinks& places) {
    std::map<SubmapKey, int> links;
    for (const LinkEdge& edge : places.found) {
      ++links[edge.link.a];
      ++links[edge.link.b];
    }
    return links;
  }

  PlaceScene scene_;
  std::vector<ScenePoint> points_;
  Submap front_, back_, later_;
};

bool near_in_time(const Place& a, const Place& b) {
  return std::abs(a.image.utime_us - b.image.utime_us) < kLaterUs / 2;
}

bool apart(const Place& /*a*/, const Place& /*b*/) { return false; }

TEST_F(PlaceSearchTest, FindsAPlaceSeenTwice) {
  PlaceLinks places;
  PlaceSearch({}).search({{kFront, &front_}, {kLater, &later_}}, apart, &places);
  EXPECT_GE(links_of(places)[kFront], 2);
}

TEST_F(PlaceSearchTest, ImagesThatHaveTooLittleInCommonAreNotAligned) {
  const Submaps both{{kFront, &front_}, {kLater, &later_}};
  PlaceLinks never, always, usual;
  PlaceSearch({.alignment = {}, .min_alike = 100'000}).search(both, apart, &never);
  EXPECT_TRUE(never.found.empty());
  EXPECT_TRUE(never.refused.empty());
  // The limit saves time without losing a place.
  PlaceSearch({.alignment = {}, .min_alike = 0}).search(both, apart, &always);
  PlaceSearch({}).search(both, apart, &usual);
  EXPECT_EQ(links_of(usual), links_of(always));
}

TEST_F(PlaceSearchTest, AnImageIsSearchedForOnceWhereItsSubmapsAreJoined) {
  PlaceLinks joined_places, apart_places;
  PlaceSearch joined({}), separate({});
  for (const Submaps& submaps : {Submaps{{kLater, &later_}}, Submaps{{kLater, &later_}, {kFront, &front_}}}) {
    joined.search(submaps, near_in_time, &joined_places);
    separate.search(submaps, near_in_time, &apart_places);
  }
  ASSERT_GE(links_of(joined_places)[kFront], 2);
  ASSERT_EQ(links_of(apart_places), links_of(joined_places));

  const Submaps all{{kLater, &later_}, {kFront, &front_}, {kBack, &back_}};
  joined.search(all, near_in_time, &joined_places);
  EXPECT_EQ(links_of(joined_places)[kBack], 0);
  separate.search(all, apart, &apart_places);
  EXPECT_GE(links_of(apart_places)[kBack], 2) << "what is not joined is to be found of its own";
}

TEST_F(PlaceSearchTest, WhatWaitsIsNeitherSearchedForNorFoundUntilLater) {
  const Submaps both{{kFront, &front_}, {kLater, &later_}};
  PlaceLinks places;
  PlaceSearch search({});
  search.search(both, apart, &places, [](const Place& place) { return place.submap == kLater; });
  EXPECT_TRUE(places.found.empty());
  EXPECT_EQ(places.known.size(), front_.keyframes.size());
  search.search(both, apart, &places);
  EXPECT_GE(links_of(places)[kFront], 2);
  EXPECT_EQ(places.known.size(), front_.keyframes.size() + later_.keyframes.size());
}

TEST_F(PlaceSearchTest, WhatHangsOnNothingIsSearchedForAgainWhenMoreIsKnownOfIt) {
  Submap young = later_;
  std::vector<int> unknown_yet;
  for (const auto& [id, landmark] : young.landmarks)
    if (id % 30 != 0) unknown_yet.push_back(id);
  for (int id : unknown_yet) young.remove_landmark(id);
  PlaceLinks places;
  PlaceSearch search({});
  search.search({{kFront, &front_}, {kLater, &young}}, apart, &places);
  ASSERT_TRUE(places.found.empty());
  EXPECT_TRUE(search.search_again({kLater}, {{kFront, &front_}, {kLater, &young}}, apart, &places));
  EXPECT_TRUE(places.found.empty());

  later_.revision = young.revision + 1;
  const Submaps grown{{kFront, &front_}, {kLater, &later_}};
  search.search(grown, apart, &places);
  EXPECT_TRUE(places.found.empty()) << "its keyframes are not new";
  EXPECT_TRUE(search.search_again({kLater}, grown, apart, &places));
  EXPECT_GE(links_of(places)[kFront], 2);
  EXPECT_FALSE(search.search_again({kLater}, grown, apart, &places)) << "nothing has changed since";
  EXPECT_FALSE(search.search_again({}, grown, apart, &places));
}

// A search that was broken off can be repeated from the earlier links: what the PlaceSearch itself has learned
// meanwhile does no harm.
TEST_F(PlaceSearchTest, ASearchThatBreaksOffIsMadeAgainFromWhatWasKnownBefore) {
  const Submaps both{{kFront, &front_}, {kLater, &later_}};
  PlaceSearch search({});
  PlaceLinks before;
  search.search({{kFront, &front_}}, apart, &before);
  int asked = 0;
  const auto breaks_off = [&](const Place&, const Place&) -> bool {
    return ++asked > 20 ? throw std::runtime_error("broken") : false;
  };
  PlaceLinks lost = before, places = before, expected = before;
  EXPECT_THROW(search.search(both, breaks_off, &lost), std::runtime_error);
  ASSERT_GT(lost.known.size(), before.known.size());
  search.search(both, apart, &places);
  PlaceSearch({}).search(both, apart, &expected);  // another PlaceSearch, which knows only the links
  ASSERT_GE(links_of(places)[kFront], 2);
  ASSERT_EQ(places.found.size(), expected.found.size());
  for (size_t i = 0; i < places.found.size(); ++i) EXPECT_EQ(places.found[i].link, expected.found[i].link);
}

}  // namespace
}  // namespace rumi::map_server
