// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/map_status_pages.h"

#include <gtest/gtest.h>

#include "bus/transport/bus.h"
#include "bus/wire/map_overview.h"

namespace rumi::map_server {
namespace {

constexpr int64_t kDatagramBytes = 60'000;

class MapStatusPagesTest : public ::testing::Test {
 protected:
  void make(int submaps, int links) {
    for (int i = 1; i <= submaps; ++i) change({7, i % 3 == 0 ? -i : i}, 1);
    std::vector<Link> list;
    for (int i = 0; i < links; ++i)
      list.push_back({.a = {7, 1}, .b = {7, 2}, .keyframes = i, .doubt = std::string(i % 2 == 0 ? 0 : 300, 'x')});
    EXPECT_TRUE(atlas_.set_links(std::move(list)));
  }
  void change(SubmapKey key, int64_t revision) {
    EXPECT_TRUE(atlas_.change_submap(key, [&](Submap* submap) {
      submap->key = key;
      submap->kind = key.id < 0 ? SubmapKind::kBack : SubmapKind::kFront;
      submap->revision = revision;
      return Result<>();
    }));
  }
  // Returns the next page, encoded and decoded again.
  map_status_t next() {
    const std::vector<uint8_t> bytes = encode_message(pages_.next(atlas_, ++now_us_));
    EXPECT_LE(static_cast<int64_t>(bytes.size()), kDatagramBytes);
    map_status_t page;
    EXPECT_TRUE(Bus::decode(bytes, &page));
    return page;
  }
  bool lists(const map_status_t& page, SubmapKey key) {
    return std::any_of(page.submaps.begin(), page.submaps.end(), [&](const submap_summary_t& s) {
      return SubmapKey{s.session, s.submap_id} == key;
    });
  }
  void expect_all(const MapOverview& overview) {
    ASSERT_TRUE(overview.complete());
    ASSERT_EQ(overview.submaps().size(), atlas_.submaps().size());
    for (const auto& [key, owner] : atlas_.submaps())
      EXPECT_EQ(overview.submaps().at(key).revision, owner.submap.revision);
    ASSERT_EQ(overview.links().size(), atlas_.links().size());
    for (const auto& [number, link] : overview.links()) EXPECT_EQ(link.keyframes, number);
  }

  Atlas atlas_;
  MapStatusPages pages_;
  int64_t now_us_ = 0;
};

TEST_F(MapStatusPagesTest, WhatFitsIsToldWhole) {
  make(200, 150);
  for (int i = 0; i < 3; ++i) {
    const map_status_t page = next();
    EXPECT_EQ(page.nsubmaps, 200);
    EXPECT_EQ(page.nlinks, 150);
    EXPECT_EQ(page.front_submaps, 134);
    EXPECT_EQ(page.back_submaps, 66);
    EXPECT_EQ(page.submaps_in_map, 1);
    EXPECT_EQ(page.links_in_all, 150);
    EXPECT_EQ(page.links_accepted, 75);
  }
}

TEST_F(MapStatusPagesTest, AThousandSubmapsAndFiveThousandLinksFitDatagramsAndALateComerLearnsAll) {
  make(1000, 5000);
  for (int i = 0; i < 10; ++i) next();
  MapOverview late;
  int pages = 0;
  while (!late.complete() && pages < 100) late.take(next()), ++pages;
  expect_all(late);
  RecordProperty("pages", pages);
  std::printf("all is told in %d pages\n", pages);
  EXPECT_LE(pages, 40);
}

TEST_F(MapStatusPagesTest, WhatChangedIsToldFirst) {
  make(1000, 5000);
  for (int i = 0; i < 10; ++i) next();
  for (int i = 2; i < 30; ++i) {
    change({7, 500}, i);
    EXPECT_TRUE(lists(next(), {7, 500}));
  }
}

TEST_F(MapStatusPagesTest, WhoComesLateLearnsAllThoughEverythingChangesAllTheTime) {
  make(1000, 10);
  MapOverview late;
  for (int i = 2; !late.complete() && i < 100; ++i) {
    for (int id = 1; id <= 700; ++id)
      if (id % 3 != 0) change({7, id}, i);
    late.take(next());
  }
  EXPECT_TRUE(late.complete());
}

TEST_F(MapStatusPagesTest, ARoundTellsAllAndEnds) {
  make(1000, 5000);
  for (int i = 0; i < 7; ++i) next();
  EXPECT_FALSE(pages_.round_goes_on());
  pages_.begin_round();
  MapOverview overview;
  int pages = 0;
  while (pages_.round_goes_on() && pages < 100) overview.take(next()), ++pages;
  expect_all(overview);
  // A later change does not prolong the round, but waits for the next second.
  change({7, 2001}, 1);
  EXPECT_FALSE(pages_.round_goes_on());
}

TEST_F(MapStatusPagesTest, ASmallMapsRoundIsOnePage) {
  make(3, 2);
  pages_.begin_round();
  EXPECT_TRUE(pages_.round_goes_on());
  next();
  EXPECT_FALSE(pages_.round_goes_on());
}

}  // namespace
}  // namespace rumi::map_server
