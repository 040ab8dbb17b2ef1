// SPDX-License-Identifier: BSD-3-Clause
// Arranges the submaps of a map before they are adjusted: places one after another along the links between them, bends
// them at their joints, and refuses links that the others contradict.
#pragma once

#include <map>
#include <optional>
#include <set>

#include "map_server/links/link_graph.h"
#include "map_server/merging/build_input.h"
#include "map_server/merging/map_part.h"
#include "map_server/model/map_graph.h"
#include "map_server/model/map_model.h"

namespace rumi::map_server {

using PlacedSubmaps = std::map<SubmapKey, PlacedSubmap>;

struct ArrangementOptions {
  MapGraphOptions graph;
  int weld_keyframes = 500;  // about so many keyframes of submaps around the new ones are bent with them
};

struct Arrangement {
  std::set<SubmapKey> members;  // all submaps of the map
  MapPart part = {};            // those that are arranged
  SubmapKey anchor = {};        // the submap of the part whose beginning stays where it is
  PlacedSubmaps submaps = {};   // of the part
};

// Arranges these members. Refuses in the graph the links that the others contradict, chooses the members again, and
// begins anew until no link is contradicted. Returns nothing if no member has a frame, or nothing joins them.
std::optional<Arrangement> arrange(std::set<SubmapKey> members, const BuildInput& input,
                                   const ArrangementOptions& options, LinkGraph* graph);

}  // namespace rumi::map_server
