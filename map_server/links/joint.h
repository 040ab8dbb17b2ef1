// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tuple>

#include "slam/geometry/transform.h"
#include "slam/map/submap.h"

namespace rumi::map_server {

struct KeyframeRef {
  SubmapKey submap;
  int id = kNone;
};

// A joint: the relation between two keyframes, known from another source than their own submaps.
struct KeyframeJoint {
  KeyframeRef a, b;
  Sim3 b_from_a;  // from camera a (in the unit of a's submap) to camera b (in the unit of b's submap)
  double sigma_rotation_rad = 0, sigma_translation = 0, sigma_log_scale = 0;  // sigma_translation: in b's unit
};

// Identifies a joint by its two keyframes: submap and id of a, submap and id of b.
using JointName = std::tuple<SubmapKey, int, SubmapKey, int>;
inline JointName name_of(const KeyframeJoint& joint) {
  return {joint.a.submap, joint.a.id, joint.b.submap, joint.b.id};
}

}  // namespace rumi::map_server
