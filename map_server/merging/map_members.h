// SPDX-License-Identifier: BSD-3-Clause
// Decides which submaps belong to the map.
#pragma once

#include <set>

#include "map_server/links/link_graph.h"
#include "map_server/merging/build_input.h"

namespace rumi::map_server {

// Chooses the submaps of the map: the group of joined submaps with most frames of present sessions; if groups are
// equal, the one with most frames, and then one with a front submap. If there are fixed submaps, it is their group.
// Submaps that were placed together earlier, but whose edge was refused since, are in different groups.
std::set<SubmapKey> choose_members(const LinkGraph& graph, const BuildInput& input);

}  // namespace rumi::map_server
