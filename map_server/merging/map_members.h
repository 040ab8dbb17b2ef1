// SPDX-License-Identifier: BSD-3-Clause
// Which submaps the map is made of.
#pragma once

#include <set>

#include "map_server/links/link_graph.h"
#include "map_server/merging/build_input.h"

namespace rumi::map_server {

// The largest group, in frames of the sessions that are preferred and then of all, of submaps that hang together, with
// or without a front submap among them; with fixed ones, their group. That two were placed before is no reason: an edge
// that turned out to be wrong holds nothing any more.
std::set<SubmapKey> choose_members(const LinkGraph& graph, const BuildInput& input);

}  // namespace rumi::map_server
