// SPDX-License-Identifier: BSD-3-Clause
// A map to be served: which submaps form it, and where they lie in it. Its numbers are checked when it is made, which
// takes long for a large map and needs no atlas; an atlas then takes it over quickly.
#pragma once

#include <optional>
#include <set>
#include <utility>

#include "base/result.h"
#include "map_server/atlas/placement.h"

namespace rumi::map_server {

class PlacedMap {
 public:
  PlacedMap() = default;  // no submaps
  // `unmoved`: submaps that form the map too and keep the placement that they have. An Error for a number that is not
  // finite, or a landmark fused into one of a submap that is not in this map.
  static Result<PlacedMap> make(Placements placements, std::set<SubmapKey> unmoved = {});

  const Placements& placements() const { return placements_; }
  const std::set<SubmapKey>& unmoved() const { return unmoved_; }
  bool contains(SubmapKey key) const { return placements_.contains(key) || unmoved_.contains(key); }
  std::set<SubmapKey> submaps() const;

  void add_unmoved(const std::set<SubmapKey>& keys) { unmoved_.insert(keys.begin(), keys.end()); }
  // The submaps whose placement is the one that they have already, to the bit. Without it the atlas compares.
  void note_same(std::set<SubmapKey> same) { same_ = std::move(same); }
  const std::optional<std::set<SubmapKey>>& same() const { return same_; }
  Placement take_placement(SubmapKey key) { return std::move(placements_.at(key)); }

 private:
  Placements placements_;
  std::set<SubmapKey> unmoved_;
  std::optional<std::set<SubmapKey>> same_;
};

}  // namespace rumi::map_server
