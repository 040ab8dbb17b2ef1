// SPDX-License-Identifier: BSD-3-Clause
// The input of a build, besides the link graph.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <set>

#include "map_server/atlas/placement.h"
#include "map_server/links/submaps.h"

namespace rumi::map_server {

enum class BuildScope {
  kWeld,      // only submaps that have been joined since the last build, and those around them
  kOnTheWay,  // the whole map, with the points that its submaps have in common: for a map that still grows
  kAll,       // the whole map, and its points are searched for in all its images
};

struct BuildInput {
  Submaps submaps;
  BuildScope scope = BuildScope::kAll;
  // Placements of the submaps that are in the served map. Submaps keep them until the adjustment.
  Placements placed = {};
  // Placements of the submaps in the map beside the served one (of earlier sessions). They are used instead of `placed`
  // as soon as one of these submaps is joined to the members of the map.
  Placements beside = {};
  // The submaps of the stored map, if localize_only. No build moves or culls them; others are placed in their map.
  // They are in `placed` too.
  std::set<SubmapKey> fixed = {};
  // Sessions that go on now. The group of submaps with most frames of theirs is the map.
  std::set<int64_t> present = {};
  // If given and true, every call returns soon, and its result must be thrown away.
  const std::atomic<bool>* cancel = nullptr;

  bool is_cancelled() const { return cancel && *cancel; }
};

}  // namespace rumi::map_server
