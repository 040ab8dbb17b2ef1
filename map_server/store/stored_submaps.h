// SPDX-License-Identifier: BSD-3-Clause
// The part of each submap that map.db has, so that only later changes are written.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>

#include "slam/map/submap.h"

namespace rumi::map_server {

struct StoredSubmap {
  int64_t row = 0;  // submaps.submap
  int64_t revision = 0;
  bool in_map = false;
  int64_t placement_revision = 0;          // the placement that counts in the file
  int64_t written_placement_revision = 0;  // the placement that counts as soon as those of all submaps are written
  bool may_have_others = true;             // the file may have rows of other placements
};
using StoredSubmaps = std::map<SubmapKey, StoredSubmap>;

using Deadline = std::chrono::steady_clock::time_point;

}  // namespace rumi::map_server
