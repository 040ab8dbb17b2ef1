// SPDX-License-Identifier: BSD-3-Clause
// Which submaps the map is made of.
#pragma once

#include <set>

#include "map_server/links/link_graph.h"
#include "map_server/merging/build_input.h"

namespace rumi::map_server {

// Chooses the submaps of the map: the group of joined submaps with most frames of present sessions; of equal groups the
// one with most frames, then one that has a front submap. If there are fixed submaps, it is their group. Two submaps
// that were placed before but are joined no longer (their edge was refused) are in different groups.
std::set<SubmapKey> choose_members(const LinkGraph& graph, const BuildInput& input);

}  // namespace rumi::map_server
