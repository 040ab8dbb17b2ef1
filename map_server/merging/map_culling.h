// SPDX-License-Identifier: BSD-3-Clause
// Removes from a built map what it can do without, but no keyframe that holds the map together.
#pragma once

#include <map>
#include <memory>

#include "map_server/links/link_graph.h"
#include "map_server/merging/arrangement.h"
#include "map_server/merging/build_input.h"
#include "map_server/merging/compare_submaps.h"
#include "map_server/model/map_model.h"
#include "map_server/model/post_culling.h"

namespace rumi::map_server {

// The next revisions of back submaps, without the elements that the map does not need. Their placements are kept.
using CulledSubmaps = std::map<SubmapKey, std::shared_ptr<const Submap>>;

// A map after bundle adjustment.
struct AdjustedMap {
  PlacedSubmaps submaps;  // the submaps, with their placements before the adjustment
  MapModel model = {};
  Placements placements = {};
};

class MapCulling {
 public:
  MapCulling(const PostCullingOptions& options, const PairOptions& pairs) : options_(options), pairs_(pairs) {}

  // Removes the elements that the map does not need from its back submaps, from the model and from the placements.
  // Culls a submap only if its links would be found without these elements too; therefore the graph notes the culled
  // revision as compared. Returns the culled submaps.
  CulledSubmaps cull(const BuildInput& input, LinkGraph* graph, AdjustedMap* map) const;

 private:
  bool stays_joined(const Submap& culled, const Submaps& submaps, const LinkGraph& graph) const;

  PostCullingOptions options_;
  PairOptions pairs_;
};

// Returns the common images of these submaps that culling has to treat specially.
CommonImages common_images(const Submaps& submaps, const LinkGraph& graph);

}  // namespace rumi::map_server
