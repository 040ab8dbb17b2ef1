// SPDX-License-Identifier: BSD-3-Clause
// LinkGraph is a value: all that is known of how submaps lie to each other. LinkFinder makes the next graph, with what
// it finds. MapBuilder makes the one after that: it refuses edges, and notes the contacts in the map that it built.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "map_server/links/groups.h"
#include "map_server/links/link_edge.h"
#include "map_server/links/place_links.h"
#include "map_server/links/submaps.h"

namespace rumi::map_server {

// Two submaps, as they were when their common images were compared.
struct ComparedPair {
  int64_t revision_a = 0, revision_b = 0;
  std::optional<LinkEdge> edge;  // accepted or refused; empty if they have no image in common
};

// The contacts between submaps, and between images, in the map that was built last.
struct BuiltContacts {
  std::set<SubmapKey> submaps;                       // the members of that map
  SubmapPairs touching;                              // submaps that have points in common
  std::vector<std::pair<ImageId, ImageId>> similar;  // images that have many points in common, lower first; ascending
};

struct LinkGraph {
  std::map<SubmapPair, ComparedPair> compared;
  PlaceLinks places;
  BuiltContacts built;
  // Submaps that were placed in one map before this graph began (a map of map.db), and are joined by no edge yet. They
  // count as joined, so that the map does not come apart before its submaps have been compared anew.
  std::vector<SubmapPair> tied_before;
  bool knows_tied_before = false;  // whether tied_before has been filled

  // All accepted edges. The pointers are valid until the graph changes.
  std::vector<const LinkEdge*> edges() const;
  // All links, accepted and refused: at most one of each kind between two submaps.
  std::vector<Link> links() const;

  // Groups of submaps that edges join. Edges of a submap that is left out count too: that it is left out for a while
  // says nothing against the submaps joined to it.
  Groups tied() const;
  // Groups of submaps that edges or tied_before join.
  Groups groups() const;
  // True if no other edge between these submaps joins the two sides of this one.
  bool is_only(const LinkEdge& edge, const Submaps& submaps) const;
  // The edges over which `members` can be placed one after another, beginning at those that are placed. The next edge
  // is always the one with most inliers.
  std::vector<const LinkEdge*> placing_order(std::set<SubmapKey> placed, const std::set<SubmapKey>& members) const;
  // Pairs of submaps that an edge joins, or that have points in common in the built map.
  SubmapPairs contacts() const;
  // True if the two images have many points in common in the built map.
  bool are_joined(const ImageId& a, const ImageId& b) const;
  // The edge by the same images, accepted or refused; null if they were not compared or have no image in common.
  const LinkEdge* edge_between(SubmapKey a, SubmapKey b) const;

  // Refuses edges that turned out to be wrong, with the reasons.
  void refuse(const std::map<const LinkEdge*, std::string>& doubts);
  // Drops these joints of an edge by the same images.
  void forget_joints(const LinkEdge& edge, const std::set<JointName>& joints);
  // Notes that this revision of the submap differs from the one before in nothing that was compared, so it need not be
  // compared anew.
  void take_as_compared(SubmapKey submap, int64_t revision);
};

}  // namespace rumi::map_server
