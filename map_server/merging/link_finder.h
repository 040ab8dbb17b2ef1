// SPDX-License-Identifier: BSD-3-Clause
// Finds how submaps lie relative to each other: it compares any two submaps one of which has changed since their last
// comparison, and searches for the place of every new keyframe.
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

  // Returns the next graph. The finder's own state only saves time, so it may be called with an earlier graph again.
  LinkGraph find(LinkGraph graph, const BuildInput& input);

 private:
  void compare(const BuildInput& input, LinkGraph* graph) const;
  // True if the two places need not be compared, or if their similarity would prove nothing.
  bool is_joined(const LinkGraph& graph, const Place& a, const Place& b) const;
  void search_places(const BuildInput& input, LinkGraph* graph);
  // Searches for the keyframes of submaps outside the map once more among the places of the map's members.
  void search_beside_members(const BuildInput& input, LinkGraph* graph);

  LinkFinderOptions options_;
  PlaceSearch places_;
};

}  // namespace rumi::map_server
