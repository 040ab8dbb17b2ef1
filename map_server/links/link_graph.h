// SPDX-License-Identifier: BSD-3-Clause
// LinkGraph is a value that holds all that is known about how submaps lie relative to each other. LinkFinder returns a
// new graph with the links that it finds. MapBuilder then refuses edges in its copy, and notes the contacts in the map
// that it built.
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

// The keyframes that two submaps have in common: their number, and the last revision of each submap in which one of
// them, or a landmark that it observes, changed.
struct SharedState {
  int keyframes = 0;
  int64_t revision_a = 0, revision_b = 0;
  bool operator==(const SharedState&) const = default;
};

// The result of comparing the common images of two submaps, at these revisions.
struct ComparedPair {
  int64_t revision_a = 0, revision_b = 0;
  SharedState shared = {};
  std::optional<LinkEdge> edge;  // accepted or refused; empty if they have no image in common
};

// Which submaps, and which images, have points in common in the map that was built last.
struct BuiltContacts {
  std::set<SubmapKey> submaps;                       // the members of that map
  SubmapPairs touching;                              // submaps that have points in common
  std::vector<std::pair<ImageId, ImageId>> similar;  // images with many points in common, lower first; ascending
};

struct LinkGraph {
  std::map<SubmapPair, ComparedPair> compared;
  PlaceLinks places;
  BuiltContacts built;
  // Pairs of submaps that were placed in one map before this graph began (in map.db), and that no edge joins yet. They
  // count as joined, so that the map does not fall apart before its submaps have been compared again.
  std::vector<SubmapPair> tied_before;
  bool knows_tied_before = false;  // whether tied_before has been filled

  // Returns all accepted edges. The pointers are valid until the graph changes.
  std::vector<const LinkEdge*> edges() const;
  // Returns all links, accepted and refused: at most one of each kind between two submaps.
  std::vector<Link> links() const;

  // Returns the groups of submaps that edges join. Edges of a submap that is left out of the build count too, because
  // its absence says nothing against the submaps joined to it.
  Groups tied() const;
  // Returns the groups of submaps that edges or tied_before join.
  Groups groups() const;
  // True if without this edge nothing joins its two submaps, directly or by way of other `submaps`.
  bool is_only(const LinkEdge& edge, const Submaps& submaps) const;
  // Returns the edges over which `members` can be placed one after another, beginning at those already `placed`. The
  // next edge is always the one with most inliers.
  std::vector<const LinkEdge*> placing_order(std::set<SubmapKey> placed, const std::set<SubmapKey>& members) const;
  // Returns the pairs of submaps that an edge joins, or that have points in common in the built map.
  SubmapPairs contacts() const;
  // True if the two images have many points in common in the built map.
  bool are_joined(const ImageId& a, const ImageId& b) const;
  // Returns the edge from images in common, accepted or refused; null if the two were not compared or share no image.
  const LinkEdge* edge_between(SubmapKey a, SubmapKey b) const;

  // Refuses these edges, each with its reason.
  void refuse(const std::map<const LinkEdge*, std::string>& doubts);
  // Removes these joints from an edge between submaps that share images.
  void forget_joints(const LinkEdge& edge, const std::set<JointName>& joints);
  // Notes that this revision of the submap differs from the previous one in nothing that is compared, so that it need
  // not be compared again.
  void take_as_compared(SubmapKey submap, int64_t revision);
};

}  // namespace rumi::map_server
