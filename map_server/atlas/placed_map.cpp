// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/atlas/placed_map.h"

#include <fmt/format.h>

#include <algorithm>

namespace rumi::map_server {
namespace {

bool is_valid(const Placement& placement, const PlacedMap& map) {
  return std::all_of(placement.map_from_submap.begin(), placement.map_from_submap.end(),
                     [](const auto& item) { return is_similarity(item.second); }) &&
         std::all_of(placement.landmarks.begin(), placement.landmarks.end(),
                     [](const auto& item) { return item.second.allFinite(); }) &&
         std::all_of(placement.fused.begin(), placement.fused.end(),
                     [&](const auto& item) { return map.contains(item.second.submap); });
}

}  // namespace

Result<PlacedMap> PlacedMap::make(Placements placements, std::set<SubmapKey> unmoved) {
  PlacedMap map;
  map.placements_ = std::move(placements);
  map.unmoved_ = std::move(unmoved);
  for (const auto& [key, placement] : map.placements_)
    if (!is_valid(placement, map))
      return Error{fmt::format("the placement of submap {} of session {} is not valid", key.id, key.session)};
  return map;
}

std::set<SubmapKey> PlacedMap::submaps() const {
  std::set<SubmapKey> keys = unmoved_;
  for (const auto& [key, placement] : placements_) keys.insert(key);
  return keys;
}

}  // namespace rumi::map_server
