// SPDX-License-Identifier: BSD-3-Clause
// Finds how submaps lie to each other: looks at every two of which one has changed since they were compared, and for
// the place of every keyframe that is new.
#pragma once

#include "map_server/links/link_graph.h"
#include "map_server/merging/build_input.h"
#include "map_server/merging/compare_submaps.h"
#include "map_server/places/place_search.h"

namespace rumi::map_server {

struct LinkFinderOptions {
  PairOptions pairs;
  PlaceSearchOptions places;
};

class LinkFinder {
 public:
  explicit LinkFinder(const LinkFinderOptions& options) : options_(options), places_(options.places) {}

  // The next graph. What it keeps itself only spares time: it may be asked again with a graph of before.
  LinkGraph find(LinkGraph graph, const BuildInput& input);

 private:
  void compare(const BuildInput& input, LinkGraph* graph) const;
  // No need, or no use, to compare how the two look.
  bool is_joined(const LinkGraph& graph, const Place& a, const Place& b) const;
  void search_places(const BuildInput& input, LinkGraph* graph);
  // All other submaps once more among the places of those that the map is made of.
  void search_beside_members(const BuildInput& input, LinkGraph* graph);

  LinkFinderOptions options_;
  PlaceSearch places_;
};

}  // namespace rumi::map_server
