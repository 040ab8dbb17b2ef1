// SPDX-License-Identifier: BSD-3-Clause
// A placement says where a submap lies in the served map. A submap bends when it is joined to others, so every keyframe
// has a similarity of its own, and frames and landmarks follow their keyframe. The submap itself stays as its maker
// sent it; elements that the maker changes or adds later follow the keyframe nearest in time.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>

#include "slam/map/submap.h"

namespace rumi::map_server {

// The host of a landmark, which it follows: the first keyframe that observes it. Null if no keyframe observes it.
const Keyframe* host_of(const Submap& submap, const Landmark& landmark);

struct LandmarkRef {
  SubmapKey submap;
  int id = kNone;
  auto operator<=>(const LandmarkRef&) const = default;  // NOLINT(modernize-use-nullptr): the compiler's own
};

struct Placement {
  std::map<int64_t, Sim3> map_from_submap;   // at the keyframe of that utime_us; empty: identity everywhere
  std::map<int, Eigen::Vector3d> landmarks;  // position in the map of those that a bundle adjustment of the map moved
  // Landmarks that are the same point as another landmark, of another submap or of this one; that one is fused into
  // none. If it has been removed since, they are points of their own again.
  std::map<int, LandmarkRef> fused;
  int64_t revision = 0;  // of the served map when this last changed; 0: nobody has placed the submap

  // The similarity at the keyframe nearest in time.
  Sim3 at(int64_t utime_us) const;
  // The similarity at the latest keyframe: it places a camera that goes on in the submap.
  Sim3 latest() const { return map_from_submap.empty() ? Sim3() : map_from_submap.rbegin()->second; }

  // The similarity at the frame's keyframe.
  Sim3 at(const Submap& submap, const FramePose& frame) const;

  SE3 cam_from_map(const Keyframe& keyframe) const;
  // The frame keeps its place relative to its keyframe.
  SE3 cam_from_map(const Submap& submap, const FramePose& frame) const;
  Eigen::Vector3d position_in_map(const Submap& submap, const Landmark& landmark) const;
};

using Placements = std::map<SubmapKey, Placement>;

inline bool is_similarity(const Sim3& s) { return s.is_finite() && s.scale > 0; }

// True if the two are the same to the last bit, whatever their revisions.
bool same_place(const Placement& a, const Placement& b);

// The submap as it is in the map: same ids and observations, poses and positions in the map's unit and frame of
// reference.
Submap place(const Submap& submap, const Placement& placement);

}  // namespace rumi::map_server
