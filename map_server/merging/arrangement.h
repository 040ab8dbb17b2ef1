// SPDX-License-Identifier: BSD-3-Clause
// Where the submaps of a map lie before they are adjusted: placed one after another over the links between them, bent
// where their joints ask for it, and without the links that the others contradict.
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
  int weld_keyframes = 500;  // of the submaps around what is new that are bent with it, about
};

struct Arrangement {
  std::set<SubmapKey> members;  // of the map
  MapPart part = {};            // of it, that is looked at
  SubmapKey anchor = {};        // the submap of the part whose beginning stays where it is
  PlacedSubmaps submaps = {};   // of the part
};

// Of these members; again without what the others contradict, which the graph is told of, and with the members that
// this leaves, until nothing does. Nothing: none of them has a frame, or nothing joins them.
std::optional<Arrangement> arrange(std::set<SubmapKey> members, const BuildInput& input,
                                   const ArrangementOptions& options, LinkGraph* graph);

}  // namespace rumi::map_server
