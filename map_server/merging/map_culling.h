// SPDX-License-Identifier: BSD-3-Clause
// What post-culling leaves out of a map that has been built, and what stays because it holds the map together.
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

// The next revision of back submaps, without what the map can do without; placed like that.
using CulledSubmaps = std::map<SubmapKey, std::shared_ptr<const Submap>>;

// A map after its adjustment.
struct AdjustedMap {
  PlacedSubmaps submaps;  // as they were placed before it
  MapModel model = {};
  Placements placements = {};
};

class MapCulling {
 public:
  MapCulling(const PostCullingOptions& options, const PairOptions& pairs) : options_(options), pairs_(pairs) {}

  // Leaves what the map can do without out of its back submaps, and of all else. Whatever was joined to them could be
  // joined to what is left; the graph takes it as compared.
  CulledSubmaps cull(const BuildInput& input, LinkGraph* graph, AdjustedMap* map) const;

 private:
  bool stays_joined(const Submap& culled, const Submaps& submaps, const LinkGraph& graph) const;

  PostCullingOptions options_;
  PairOptions pairs_;
};

// What the images that submaps have in common mean for culling.
CommonImages common_images(const Submaps& submaps, const LinkGraph& graph);

}  // namespace rumi::map_server
