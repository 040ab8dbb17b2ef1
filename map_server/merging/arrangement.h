// SPDX-License-Identifier: BSD-3-Clause
// Arranges the submaps of a map before bundle adjustment: places them one after another along the links between them,
// bends them at their joints, and refuses links that other links contradict.
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
  int weld_keyframes = 500;  // about how many keyframes a weld bends, those of new submaps included
};

struct Arrangement {
  std::set<SubmapKey> members;  // all submaps of the map
  MapPart part = {};            // members that are arranged
  SubmapKey anchor = {};        // submap of the part whose beginning does not move
  PlacedSubmaps submaps = {};   // submaps of the part
};

// Arranges these members. If links contradict others, refuses them in the graph, chooses the members again, and starts
// over until none does. Returns nullopt if no member has a frame, nothing joins the members, or the build is cancelled.
std::optional<Arrangement> arrange(std::set<SubmapKey> members, const BuildInput& input,
                                   const ArrangementOptions& options, LinkGraph* graph);

}  // namespace rumi::map_server
