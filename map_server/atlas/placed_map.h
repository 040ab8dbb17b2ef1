// SPDX-License-Identifier: BSD-3-Clause
// A map to be served: its submaps, and where they lie in it. Its numbers are checked when it is made, which takes long
// for a large map but needs no atlas; placing it in the atlas then is quick.
#pragma once

#include <optional>
#include <set>
#include <utility>

#include "base/result.h"
#include "map_server/atlas/placement.h"

namespace rumi::map_server {

class PlacedMap {
 public:
  PlacedMap() = default;  // a map without submaps
  // `unmoved`: submaps of the map that keep their present placement. An Error if a number is not finite, a scale is not
  // positive, or a landmark is fused into a landmark of a submap that is not in this map.
  static Result<PlacedMap> make(Placements placements, std::set<SubmapKey> unmoved = {});

  const Placements& placements() const { return placements_; }
  const std::set<SubmapKey>& unmoved() const { return unmoved_; }
  bool contains(SubmapKey key) const { return placements_.contains(key) || unmoved_.contains(key); }
  std::set<SubmapKey> submaps() const;

  void add_unmoved(const std::set<SubmapKey>& keys) { unmoved_.insert(keys.begin(), keys.end()); }
  // Notes the submaps whose new placement equals the present one, bit by bit. If this is not called, the atlas compares
  // them.
  void note_same(std::set<SubmapKey> same) { same_ = std::move(same); }
  const std::optional<std::set<SubmapKey>>& same() const { return same_; }
  Placement take_placement(SubmapKey key) { return std::move(placements_.at(key)); }

 private:
  Placements placements_;
  std::set<SubmapKey> unmoved_;
  std::optional<std::set<SubmapKey>> same_;
};

}  // namespace rumi::map_server
