// SPDX-License-Identifier: BSD-3-Clause
// The part of the map that a weld arranges: new submaps are bent and welded only together with the submaps around them,
// however large the map is.
#pragma once

#include <set>

#include "map_server/links/submaps.h"

namespace rumi::map_server {

struct MapPart {
  std::set<SubmapKey> submaps;
  std::set<SubmapKey> fixed;  // submaps of the part that touch submaps outside it, and therefore must not move
};

// Returns a part with the `fresh` submaps, all members in contact with them, then the members in contact with those,
// and so on until it has about `keyframes` keyframes.
MapPart part_around(const std::set<SubmapKey>& fresh, const std::set<SubmapKey>& members, const SubmapPairs& contacts,
                    const Submaps& submaps, int keyframes);

}  // namespace rumi::map_server
