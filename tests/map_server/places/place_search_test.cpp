// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_search.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/map_server/places/place_scene.h"

namespace rumi::map_server {
namespace {

const SubmapKey kFront{1, 1}, kBack{1, -1}, kLater{1, 2};
constexpr int64_t kLaterUs = 100'000'000;

// Two submaps of the same images, and a third one that comes by later.
class PlaceSearchTest : public ::testing::Test {
 protected:
  PlaceSearchTest() : scene_(3), points_(scene_.cloud(700)) {
    front_ = scene_.submap(kFront, points_, scene_.path(0, 0, 0), scene_.gauge(1));
    back_ = scene_.submap(kBack, points_, scene_.path(0, 0, 0), scene_.gauge(2));
    later_ = scene_.submap(kLater, points_, scene_.path(0.5, 0.1, 0.2, -0.1), scene_.gauge(0.7));
    later_.frames.clear();
    for (auto& [id, keyframe] : later_.keyframes) keyframe.utime_us += kLaterUs;
    for (Submap* submap : {&front_, &back_, &later_})
      for (const auto& [id, keyframe] : submap->keyframes)
        submap->frames[keyframe.utime_us] = {keyframe.utime_us, id, {}, 1};
  }

  std::map<SubmapKey, int> links_of(const PlaceSearch& search) {
    std::map<SubmapKey, int> links;
    for (const PlaceLink& place : search.found()) {
      ++links[place.link.a];
      ++links[place.link.b];
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

TEST_F(PlaceSearchTest, FindsAPlaceSeenTwice) {
  PlaceSearch search({});
  search.search({{kFront, &front_}, {kLater, &later_}}, [](const Place&, const Place&) { return false; });
  EXPECT_GE(links_of(search)[kFront], 2);
}

TEST_F(PlaceSearchTest, ImagesThatHaveTooLittleInCommonAreNotAligned) {
  const PlaceSearch::Submaps both{{kFront, &front_}, {kLater, &later_}};
  const auto apart = [](const Place&, const Place&) { return false; };
  PlaceSearch never({.alignment = {}, .min_alike = 100'000});
  never.search(both, apart);
  EXPECT_TRUE(never.found().empty());
  EXPECT_TRUE(never.refused().empty());
  // It spares time, and costs no place.
  PlaceSearch always({.alignment = {}, .min_alike = 0}), search({});
  always.search(both, apart);
  search.search(both, apart);
  EXPECT_EQ(links_of(search), links_of(always));
}

TEST_F(PlaceSearchTest, WhatTurnsOutToBeWrongIsToldAsRefused) {
  PlaceSearch search({});
  search.search({{kFront, &front_}, {kLater, &later_}}, [](const Place&, const Place&) { return false; });
  const size_t found = search.found().size();
  ASSERT_GE(found, 2u);
  search.refuse(0, "wrong");
  EXPECT_EQ(search.found().size(), found - 1);
  EXPECT_EQ(search.refused().at({kFront, kLater}).doubt, "wrong");
}

TEST_F(PlaceSearchTest, AnImageIsSearchedForOnceWhereItsSubmapsAreJoined) {
  PlaceSearch joined({}), apart({});
  joined.search({{kLater, &later_}}, near_in_time);
  apart.search({{kLater, &later_}}, near_in_time);
  joined.search({{kLater, &later_}, {kFront, &front_}}, near_in_time);
  apart.search({{kLater, &later_}, {kFront, &front_}}, near_in_time);
  ASSERT_GE(links_of(joined)[kFront], 2);
  ASSERT_EQ(links_of(apart), links_of(joined));

  const PlaceSearch::Submaps all{{kLater, &later_}, {kFront, &front_}, {kBack, &back_}};
  joined.search(all, near_in_time);
  EXPECT_EQ(links_of(joined)[kBack], 0);
  apart.search(all, [](const Place&, const Place&) { return false; });
  EXPECT_GE(links_of(apart)[kBack], 2) << "what is not joined is to be found of its own";
}

TEST_F(PlaceSearchTest, WhatHangsOnNothingIsSearchedForAgainWhenMoreIsKnownOfIt) {
  const auto apart = [](const Place&, const Place&) { return false; };
  Submap young = later_;
  std::vector<int> unknown_yet;
  for (const auto& [id, landmark] : young.landmarks)
    if (id % 30 != 0) unknown_yet.push_back(id);
  for (int id : unknown_yet) young.remove_landmark(id);
  PlaceSearch search({});
  search.search({{kFront, &front_}, {kLater, &young}}, apart);
  ASSERT_TRUE(search.found().empty());
  EXPECT_TRUE(search.search_again({kLater}, {{kFront, &front_}, {kLater, &young}}, apart));
  EXPECT_TRUE(search.found().empty());

  later_.revision = young.revision + 1;
  const PlaceSearch::Submaps grown{{kFront, &front_}, {kLater, &later_}};
  search.search(grown, apart);
  EXPECT_TRUE(search.found().empty()) << "its keyframes are not new";
  EXPECT_TRUE(search.search_again({kLater}, grown, apart));
  EXPECT_GE(links_of(search)[kFront], 2);
  EXPECT_FALSE(search.search_again({kLater}, grown, apart)) << "nothing has changed since";
  EXPECT_FALSE(search.search_again({}, grown, apart));
}

}  // namespace
}  // namespace rumi::map_server
