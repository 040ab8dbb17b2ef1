// SPDX-License-Identifier: BSD-3-Clause
// Bends submaps where their joints ask for it: a pose graph over all their keyframes, each a similarity of its own, so
// that a scale that drifted within a submap is spread along it. Done before the bundle adjustment, which would stop at
// the first wrong answer from so far away.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "map_server/map_model.h"

namespace rumi {

// Two keyframes whose relation is known from elsewhere than their own submap.
struct KeyframeJoint {
  KeyframeRef a, b;
  Sim3 b_from_a;  // between the two cameras, each in the unit of its submap
  double sigma_rotation_rad = 0, sigma_translation = 0, sigma_log_scale = 0;  // translation: in the unit of b
};

// Of which two keyframes it is.
using JointName = std::tuple<SubmapKey, int, SubmapKey, int>;
inline JointName name_of(const KeyframeJoint& joint) {
  return {joint.a.submap, joint.a.id, joint.b.submap, joint.b.id};
}

struct MapGraphOptions {
  // Of the pose of one keyframe relative to another with which it shares 100 landmarks; it grows as their number falls.
  double sigma_rotation_deg = 0.1;
  double sigma_translation = 0.01;  // of the median depth
  double sigma_log_scale = 0.005;
  int neighbours = 5;  // of a keyframe, besides the next one in time
  int min_shared_landmarks = 15;
};

struct MapGraphReport {
  bool bent = false;               // false: nothing was changed
  std::vector<double> joint_chi2;  // per joint, after bending
};

// Moves the keyframes of the submaps; those of the anchor's first keyframe stays. Positions of landmarks that were
// adjusted before follow their keyframes.
MapGraphReport bend(const std::vector<KeyframeJoint>& joints, SubmapKey anchor, const MapGraphOptions& options,
                    std::map<SubmapKey, PlacedSubmap>* submaps);

}  // namespace rumi
