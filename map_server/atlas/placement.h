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

// Returns the host of a landmark, the first keyframe that observes it: the landmark follows it. Null if no keyframe
// does.
const Keyframe* host_of(const Submap& submap, const Landmark& landmark);

struct LandmarkRef {
  SubmapKey submap;
  int id = kNone;
  auto operator<=>(const LandmarkRef&) const = default;  // NOLINT(modernize-use-nullptr): the compiler's own
};

struct Placement {
  std::map<int64_t, Sim3> map_from_submap;   // by the utime_us of keyframes; empty: identity everywhere
  std::map<int, Eigen::Vector3d> landmarks;  // positions in the map of the landmarks that bundle adjustment moved
  // Landmarks that are the same point as another landmark, of another submap or of this one; that other landmark is not
  // fused into any. If it is removed later, the landmarks are points of their own again.
  std::map<int, LandmarkRef> fused;
  int64_t revision = 0;  // the served map's revision when this placement last changed; 0: never placed

  // Returns the similarity at the keyframe nearest in time.
  Sim3 at(int64_t utime_us) const;
  // Returns the similarity at the latest keyframe, by which a camera that goes on in the submap is placed.
  Sim3 latest() const { return map_from_submap.empty() ? Sim3() : map_from_submap.rbegin()->second; }

  // Returns the similarity at the frame's keyframe.
  Sim3 at(const Submap& submap, const FramePose& frame) const;

  SE3 cam_from_map(const Keyframe& keyframe) const;
  // Returns the frame's pose in the map; the frame keeps its pose relative to its keyframe.
  SE3 cam_from_map(const Submap& submap, const FramePose& frame) const;
  Eigen::Vector3d position_in_map(const Submap& submap, const Landmark& landmark) const;
};

using Placements = std::map<SubmapKey, Placement>;

inline bool is_similarity(const Sim3& s) { return s.is_finite() && s.scale > 0; }

// True if the two are equal to the last bit, apart from their revisions.
bool same_place(const Placement& a, const Placement& b);

// Returns the submap as it lies in the map: with the same ids and observations, and with poses and positions in the
// map's unit and frame of reference.
Submap place(const Submap& submap, const Placement& placement);

}  // namespace rumi::map_server
