// SPDX-License-Identifier: BSD-3-Clause
// Culls a map that has been built, except for the keyframes that hold the map together.
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

// Back submaps in their next revision, without the elements that the map does not need. Their placements stay.
using CulledSubmaps = std::map<SubmapKey, std::shared_ptr<const Submap>>;

// A map after its adjustment.
struct AdjustedMap {
  PlacedSubmaps submaps;  // with their placements before the adjustment
  MapModel model = {};
  Placements placements = {};
};

class MapCulling {
 public:
  MapCulling(const PostCullingOptions& options, const PairOptions& pairs) : options_(options), pairs_(pairs) {}

  // Removes the elements that the map does not need from its back submaps, from the model and from the placements. A
  // submap is culled only if its links would be found without them too; so the graph notes it as compared.
  CulledSubmaps cull(const BuildInput& input, LinkGraph* graph, AdjustedMap* map) const;

 private:
  bool stays_joined(const Submap& culled, const Submaps& submaps, const LinkGraph& graph) const;

  PostCullingOptions options_;
  PairOptions pairs_;
};

// Finds what culling must know of the images that submaps have in common.
CommonImages common_images(const Submaps& submaps, const LinkGraph& graph);

}  // namespace rumi::map_server
