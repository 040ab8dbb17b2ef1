// SPDX-License-Identifier: BSD-3-Clause
// Makes one map of the submaps that links connect (paper, section IV.C): arranges, welds, adjusts and culls them. It
// uses no clock and no threads and does not change its input: the same input gives the same map.
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
  int joined_points = 15;    // two views that share so many points need no place search
  int weld_neighbours = 30;  // views around new ones that are adjusted with them
  int association_rounds =
      2;  // of BuildScope::kAll: association, then bundle adjustment; the radius is halved each time
};

struct MapBuildReport {
  int members = 0;         // submaps of the map
  int views = 0;           // of the map
  int adjusted_views = 0;  // of those
  int points = 0, observations = 0, outliers = 0;
  double rmse = 0;              // reprojection, sigma
  int observed = 0, fused = 0;  // by association
};

struct BuiltMap {
  LinkGraph graph;  // the next one
  // The submaps of the map together. Without placements nothing was joined or adjusted.
  Placements placements = {};
  std::set<SubmapKey> unmoved = {};
  CulledSubmaps culled = {};
  MapBuildReport report = {};
};

class MapBuilder {
 public:
  explicit MapBuilder(const MapBuilderOptions& options) : options_(options) {}

  // `graph`: what LinkFinder found in the same input.
  BuiltMap build(LinkGraph graph, const BuildInput& input) const;

 private:
  std::vector<int> weld_window(const BuiltContacts& before, const MapModel& model) const;
  // The views that are adjusted; empty: all.
  std::vector<int> window_of(const BuildInput& input, const BuiltContacts& before, const MapModel& model) const;
  MapBuildReport adjust(const BuildInput& input, const BuiltContacts& before, MapModel* model) const;

  MapBuilderOptions options_;
};

}  // namespace rumi::map_server
