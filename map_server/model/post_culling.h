// SPDX-License-Identifier: BSD-3-Clause
// Post-culling (paper, section IV.C.3): a back submap repeats images that front submaps have too, and was made of more
// images than it needs. What the map can do without is taken out of it; every frame keeps its pose in the map.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "map_server/model/map_graph.h"
#include "map_server/model/map_model.h"

namespace rumi::map_server {

struct PostCullingOptions {
  bool enabled = true;
  double redundant_share = 0.9;  // of the points of an image, that enough other images see: it adds nothing
  int observers = 3;             // that is enough, as finely
};

using KeyframeSets = std::map<SubmapKey, std::set<int>>;  // ids

// What culling must know of the images that submaps have in common.
struct CommonImages {
  KeyframeSets needed;                 // hold the map together, or might yet: they stay
  std::vector<KeyframeJoint> doubled;  // two keyframes of one image that agree: one of them is enough
};

// The keyframes of closed back submaps that the map, adjusted, can do without.
KeyframeSets find_redundant(const MapModel& model, const std::map<SubmapKey, PlacedSubmap>& submaps,
                            const CommonImages& common, const PostCullingOptions& options);

// The next revision of the submap: without these keyframes, and without the landmarks that fewer than two keyframes are
// left to see. Their frames hang on the keyframe nearest in time, each where the placement has it. If none would be
// left, the submap as it is.
Submap without_keyframes(const Submap& submap, const Placement& placement, const std::set<int>& keyframes);

}  // namespace rumi::map_server
