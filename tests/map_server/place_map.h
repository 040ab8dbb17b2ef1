// SPDX-License-Identifier: BSD-3-Clause
// Places submaps and applies updates in one call, for tests.
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

#include "bus/wire/submap_update.h"
#include "map_server/atlas/atlas.h"

namespace rumi::testing {

// Places the submaps. Returns the reason why the atlas refuses it, or an empty string if it does not.
inline std::string place_error(map_server::Atlas* atlas, map_server::Placements placements,
                               std::set<SubmapKey> unmoved = {}) {
  Result<map_server::PlacedMap> map = map_server::PlacedMap::make(std::move(placements), std::move(unmoved));
  if (!map) return map.error().text();
  return atlas->place_map(std::move(*map)).error_text();
}

inline void place_map(map_server::Atlas* atlas, map_server::Placements placements, std::set<SubmapKey> unmoved = {}) {
  EXPECT_EQ(place_error(atlas, std::move(placements), std::move(unmoved)), "");
}

}  // namespace rumi::testing
