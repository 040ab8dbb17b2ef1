// SPDX-License-Identifier: BSD-3-Clause
// Makes one map of the submaps that links connect (paper, section IV.C): arranges, welds, adjusts and culls them. Uses
// no clock and no threads, and does not change its input, so the same input always gives the same map.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <vector>

#include "map_server/links/link_graph.h"
#include "map_server/merging/arrangement.h"
#include "map_server/merging/build_input.h"
#include "map_server/merging/link_finder.h"
#include "map_server/merging/map_culling.h"
#include "map_server/model/map_association.h"
#include "map_server/model/map_bundle.h"
#include "map_server/model/map_model.h"

namespace rumi::map_server {

struct MapBuilderOptions {
  LinkFinderOptions links;
  ArrangementOptions arrangement;
  MapBundleOptions bundle;
  AssociationOptions association;
  PostCullingOptions culling;
  int joined_points = 15;      // two views with at least this many points in common need no place search
  int weld_neighbours = 30;    // most views around new ones that are adjusted with them
  int association_rounds = 2;  // if kAll: association, then bundle adjustment; the search radius is halved each time
};

struct MapBuildReport {
  int members = 0;         // submaps in the map
  int views = 0;           // images in the map
  int adjusted_views = 0;  // images whose pose was adjusted
  int points = 0, observations = 0, outliers = 0;
  double rmse = 0;              // root mean square of the reprojection errors, over their standard deviation
  int observed = 0, fused = 0;  // observations added and points fused by association
};

struct BuiltMap {
  LinkGraph graph;  // must be passed to the next build
  // The submaps of the map are those of `placements` and `unmoved`. Without placements nothing was joined or adjusted.
  Placements placements = {};
  std::set<SubmapKey> unmoved = {};
  CulledSubmaps culled = {};
  MapBuildReport report = {};
};

class MapBuilder {
 public:
  explicit MapBuilder(const MapBuilderOptions& options) : options_(options) {}

  // `graph`: LinkFinder's result for the same input.
  BuiltMap build(LinkGraph graph, const BuildInput& input) const;

 private:
  std::vector<int> weld_window(const BuiltContacts& before, const MapModel& model) const;
  // Returns the views that are adjusted; empty means all.
  std::vector<int> window_of(const BuildInput& input, const BuiltContacts& before, const MapModel& model) const;
  MapBuildReport adjust(const BuildInput& input, const BuiltContacts& before, MapModel* model) const;

  MapBuilderOptions options_;
};

}  // namespace rumi::map_server
