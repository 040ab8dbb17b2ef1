// SPDX-License-Identifier: BSD-3-Clause
// What a map is built of, besides what is known of the links.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <set>

#include "map_server/atlas/placement.h"
#include "map_server/links/submaps.h"

namespace rumi::map_server {

enum class BuildScope {
  kWeld,      // submaps that have been joined since the last build, and what is around them; else nothing
  kOnTheWay,  // the whole map, by what its submaps have in common: one that still grows
  kAll,       // the whole map, and every image in which its points are found
};

using Placements = std::map<SubmapKey, Placement>;

struct BuildInput {
  Submaps submaps;
  BuildScope scope = BuildScope::kAll;
  // Where submaps are in the map as it is; they stay there until the adjustment.
  Placements placed = {};
  // Where others are in a map of earlier sessions, which counts instead of it as soon as one of them hangs together
  // with the rest.
  Placements kept = {};
  // A map of an earlier session, that stays as it is to the bit: what comes is placed in it. Among the placed ones.
  // Nothing is culled then.
  std::set<SubmapKey> fixed = {};
  // What these sessions have comes before what earlier ones have left: it is the map, with what hangs together with it.
  std::set<int64_t> preferred = {};
  // If given and true, every call returns soon; what it returns is to be thrown away.
  const std::atomic<bool>* cancel = nullptr;

  bool is_cancelled() const { return cancel && *cancel; }
};

}  // namespace rumi::map_server
