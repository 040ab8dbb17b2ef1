// SPDX-License-Identifier: BSD-3-Clause
// The input of a build, apart from the link graph.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <set>

#include "map_server/atlas/placement.h"
#include "map_server/links/submaps.h"

namespace rumi::map_server {

enum class BuildScope {
  kWeld,      // only submaps joined since the last build, and the submaps around them
  kOnTheWay,  // the whole map, without searching for more common points: for a map that still grows
  kAll,       // the whole map, and its points are searched for in all its images
};

struct BuildInput {
  Submaps submaps;
  BuildScope scope = BuildScope::kAll;
  // Placements of the submaps in the served map, which the build starts from.
  Placements placed = {};
  // Placements of the submaps in the map beside the served one (of earlier sessions). They replace `placed` as soon as
  // one of these submaps is joined to the members of the map.
  Placements beside = {};
  // The submaps of the stored map if localize_only, also contained in `placed`. No build moves or culls them; others
  // are placed relative to them.
  std::set<SubmapKey> fixed = {};
  // Sessions that go on now. The group of submaps with most frames of these sessions becomes the map.
  std::set<int64_t> present = {};
  // Null, or a flag that cancels the build: once it is true, every call returns soon, and its result must be discarded.
  const std::atomic<bool>* cancel = nullptr;
  // Null, or a flag that is true once the build has taken long enough: it ends soon, and its map counts as it is then.
  const std::atomic<bool>* enough = nullptr;

  bool is_cancelled() const { return cancel && *cancel; }
  bool must_end() const { return is_cancelled() || (enough && *enough); }
};

}  // namespace rumi::map_server
