// SPDX-License-Identifier: BSD-3-Clause
// The part of the map that is looked at when something is added to it: however large the map, an addition is bent and
// welded with what lies around it.
#pragma once

#include <set>

#include "map_server/links/submaps.h"

namespace rumi::map_server {

struct MapPart {
  std::set<SubmapKey> submaps;
  std::set<SubmapKey> held;  // of those: what is outside hangs on them, so they stay where they are
};

// Those that are `fresh`, all that they are in contact with, and what that is in contact with in turn, until there are
// about so many keyframes. Only members count.
MapPart part_around(const std::set<SubmapKey>& fresh, const std::set<SubmapKey>& members, const SubmapPairs& contacts,
                    const Submaps& submaps, int keyframes);

}  // namespace rumi::map_server
