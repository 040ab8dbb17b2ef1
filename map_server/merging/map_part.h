// SPDX-License-Identifier: BSD-3-Clause
// The part of the map that a weld arranges: however large the map, an addition is bent and welded only with what lies
// around it.
#pragma once

#include <set>

#include "map_server/links/submaps.h"

namespace rumi::map_server {

struct MapPart {
  std::set<SubmapKey> submaps;
  std::set<SubmapKey> fixed;  // those of them that touch submaps outside the part, so they must stay where they are
};

// The part has the `fresh` submaps, all members in contact with them, and then members in contact with those, until it
// has about `keyframes` keyframes.
MapPart part_around(const std::set<SubmapKey>& fresh, const std::set<SubmapKey>& members, const SubmapPairs& contacts,
                    const Submaps& submaps, int keyframes);

}  // namespace rumi::map_server
