// SPDX-License-Identifier: BSD-3-Clause
// All that is known of how submaps lie to each other: a value. LinkFinder adds what it finds and makes the next one.
// MapBuilder makes the one after that, with the edges that it refused and what touches what in the map that it built.
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
  std::optional<LinkEdge> edge;  // accepted or refused; nothing: they have no image in common
};

// What touches what in the map that was built last.
struct BuiltContacts {
  std::set<SubmapKey> submaps;                       // that it is made of
  SubmapPairs touching;                              // submaps that have points in common
  std::vector<std::pair<ImageId, ImageId>> similar;  // images that have many points in common, lower first; ascending
};

struct LinkGraph {
  std::map<SubmapPair, ComparedPair> compared;
  PlaceLinks places;
  BuiltContacts built;
  // Of a map that another graph held together this one may have fewer edges: without a reason it does not come apart.
  // What an edge holds together since is the edge's.
  std::vector<SubmapPair> inherited;
  bool has_inherited = false;  // false: nobody has looked yet for such a map

  // All that are accepted. Pointers hold until the graph changes.
  std::vector<const LinkEdge*> edges() const;
  // One for every two submaps that have something in common, of each kind: accepted and refused ones.
  std::vector<Link> links() const;

  // Which submaps hang together by edges. Also by submaps that are not here now: that one is left out for a while says
  // nothing against what hangs on it.
  Groups tied() const;
  // By edges, or as they were inherited.
  Groups groups() const;
  // The two sides of the edge hang together by nothing else, of these submaps.
  bool is_only(const LinkEdge& edge, const Submaps& submaps) const;
  // The edges over which `members` can be placed one after another, beginning with those that are placed: each time
  // that with most inliers.
  std::vector<const LinkEdge*> placing_order(std::set<SubmapKey> placed, const std::set<SubmapKey>& members) const;
  // Edges, and what has points in common in the built map.
  SubmapPairs contacts() const;
  // The built map knows how they lie to each other.
  bool are_joined(const ImageId& a, const ImageId& b) const;
  // By the same images. Nothing: they were not compared, or have none.
  const LinkEdge* edge_between(SubmapKey a, SubmapKey b) const;

  // Edges that turned out to be wrong, and why.
  void refuse(const std::map<const LinkEdge*, std::string>& doubts);
  // Of an edge by the same images.
  void forget_joints(const LinkEdge& edge, const std::set<JointName>& joints);
  // Nothing that was compared has changed in this revision of it.
  void take_as_compared(SubmapKey submap, int64_t revision);
};

}  // namespace rumi::map_server
