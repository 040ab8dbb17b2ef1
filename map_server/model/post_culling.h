// SPDX-License-Identifier: BSD-3-Clause
// Post-culling (paper, section IV.C.3). A back submap repeats images of front submaps, and was made of more images than
// it needs. Post-culling removes from it what the map can do without; every frame keeps its pose in the map.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "map_server/model/map_graph.h"
#include "map_server/model/map_model.h"

namespace rumi::map_server {

struct PostCullingOptions {
  bool enabled = true;
  double redundant_share = 0.9;  // an image is redundant if this share of its points is seen by enough other images
  int observers = 3;             // least number of such images; each must see the point about as finely
};

using KeyframeSets = std::map<SubmapKey, std::set<int>>;  // keyframe ids

// The images that submaps have in common.
struct CommonImages {
  KeyframeSets needed;                 // keyframes that hold the map together, or might do so later: they are kept
  std::vector<KeyframeJoint> doubled;  // pairs of keyframes of one image that agree: one of the two is enough
};

// Returns the keyframes of closed back submaps that the adjusted map can do without.
KeyframeSets find_redundant(const MapModel& model, const std::map<SubmapKey, PlacedSubmap>& submaps,
                            const CommonImages& common, const PostCullingOptions& options);

// Returns the next revision of the submap, without these keyframes and without landmarks that fewer than two remaining
// keyframes see. Their frames are attached to the keyframe nearest in time, so that each keeps its pose in the map. If
// no keyframe would remain, returns the submap unchanged.
Submap without_keyframes(const Submap& submap, const Placement& placement, const std::set<int>& keyframes);

}  // namespace rumi::map_server
