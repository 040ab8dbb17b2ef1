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

// A joint: the relation of two keyframes, known from elsewhere than their own submaps.
struct KeyframeJoint {
  KeyframeRef a, b;
  Sim3 b_from_a;  // between the two cameras; each side is in the unit of its submap
  double sigma_rotation_rad = 0, sigma_translation = 0, sigma_log_scale = 0;  // translation: in the unit of b
};

// Names a joint by its two keyframes: submap and id of a, submap and id of b.
using JointName = std::tuple<SubmapKey, int, SubmapKey, int>;
inline JointName name_of(const KeyframeJoint& joint) {
  return {joint.a.submap, joint.a.id, joint.b.submap, joint.b.id};
}

}  // namespace rumi::map_server
