// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/map_overview.h"

#include <gtest/gtest.h>

#include <climits>

namespace rumi {
namespace {

// Returns a page that lists `submaps`, of a map with `in_all` front submaps.
map_status_t page(int in_all, const std::vector<int>& submaps, int64_t map_revision = 1) {
  map_status_t status{};
  status.map_revision = map_revision;
  status.front_submaps = in_all;
  for (const int id : submaps) {
    submap_summary_t& summary = status.submaps.emplace_back();
    summary = {};
    summary.session = 7;
    summary.submap_id = id;
    summary.revision = map_revision;
  }
  status.nsubmaps = static_cast<int32_t>(submaps.size());
  return status;
}

void add_links(int in_all, int first, int count, map_status_t* status) {
  status->links_in_all = in_all;
  status->first_link = first;
  for (int i = 0; i < count; ++i) status->links.emplace_back() = {};
  status->nlinks = count;
}

TEST(MapOverview, PagesAddUp) {
  MapOverview map;
  EXPECT_FALSE(map.complete());
  map.take(page(4, {1, 2}));
  EXPECT_FALSE(map.complete());
  map.take(page(4, {3, 4}, 2));
  EXPECT_TRUE(map.complete());
  map.take(page(4, {2}, 3));
  ASSERT_EQ(map.submaps().size(), 4u);
  EXPECT_EQ(map.submaps().at({7, 1}).revision, 1);
  EXPECT_EQ(map.submaps().at({7, 2}).revision, 3);
  map.take(page(5, {}, 3));
  EXPECT_FALSE(map.complete());
}

TEST(MapOverview, ALinkIsKnownByItsNumber) {
  MapOverview map;
  map_status_t first = page(0, {}), second = page(0, {}), fewer = page(0, {});
  add_links(5, 0, 3, &first);
  add_links(5, 3, 2, &second);
  add_links(2, 0, 1, &fewer);
  map.take(first);
  EXPECT_FALSE(map.complete());
  map.take(second);
  EXPECT_TRUE(map.complete());
  EXPECT_EQ(map.links().size(), 5u);
  map.take(fewer);
  EXPECT_EQ(map.links().size(), 2u);
}

TEST(MapOverview, AnotherMapIsNotMixedWithWhatWasHeardBefore) {
  for (const map_status_t& other : {page(9, {8}, 1), page(3, {8}, 5)}) {  // a lower revision; fewer than are known
    MapOverview map;
    map.take(page(9, {1, 2, 3, 4}, 5));
    map.take(other);
    ASSERT_EQ(map.submaps().size(), 1u);
    EXPECT_TRUE(map.submaps().contains({7, 8}));
  }
}

TEST(MapOverview, NumbersThatAreNoneHarmNothing) {
  MapOverview map;
  for (const int first : {-5, INT_MIN, INT_MAX - 1}) {
    map_status_t status = page(-3, {1});
    status.back_submaps = INT_MIN;
    add_links(-1, first, 4, &status);
    map.take(status);
    EXPECT_TRUE(map.links().empty());
  }
}

}  // namespace
}  // namespace rumi
