// SPDX-License-Identifier: BSD-3-Clause
// Which revision of each submap map.db has, so that only later changes are written.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>

#include "slam/map/submap.h"

namespace rumi::map_server {

struct StoredSubmap {
  int64_t row = 0;  // row in the table submaps
  int64_t revision = 0;
  bool in_map = false;
  int64_t placement_revision = 0;          // revision of the valid placement in the file
  int64_t written_placement_revision = 0;  // revision of the placement that is valid once all are written
  bool may_have_others = true;             // the file may have rows of other placements
};
using StoredSubmaps = std::map<SubmapKey, StoredSubmap>;

using Deadline = std::chrono::steady_clock::time_point;

}  // namespace rumi::map_server
