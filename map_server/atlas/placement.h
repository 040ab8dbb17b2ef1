// SPDX-License-Identifier: BSD-3-Clause
// Where a submap lies in the served map. Not in one piece: a submap bends when it is joined to others, so every
// keyframe has a similarity of its own, and what hangs on the keyframe (frames, landmarks) follows it. The submap
// itself stays as its maker sent it; what the maker changes or adds later follows the keyframe nearest in time.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>

#include "slam/map/submap.h"

namespace rumi::map_server {

// The host of a landmark, which it follows: the first keyframe that observes it. Nothing if nobody observes it.
const Keyframe* host_of(const Submap& submap, const Landmark& landmark);

struct LandmarkRef {
  SubmapKey submap;
  int id = kNone;
  auto operator<=>(const LandmarkRef&) const = default;  // NOLINT(modernize-use-nullptr): the compiler's own
};

struct Placement {
  std::map<int64_t, Sim3> map_from_submap;   // at the keyframe of that utime_us; empty: identity everywhere
  std::map<int, Eigen::Vector3d> landmarks;  // position in the map of those that a bundle adjustment of the map moved
  // These landmarks are the same point as another submap's, or another one of this submap, which itself is fused into
  // none. Where the other one has been removed since, they stand for themselves again.
  std::map<int, LandmarkRef> fused;
  int64_t revision = 0;  // of the served map when this last changed; 0: nobody has placed the submap

  // At the keyframe nearest in time.
  Sim3 at(int64_t utime_us) const;
  // At the latest keyframe: what a camera that goes on in the submap is placed with.
  Sim3 latest() const { return map_from_submap.empty() ? Sim3() : map_from_submap.rbegin()->second; }

  // At the frame's keyframe.
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
