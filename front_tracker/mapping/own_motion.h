// SPDX-License-Identifier: BSD-3-Clause
// What moves by itself is no landmark. Two views of it may agree on a point: what keeps pace with the camera, or moves
// along an epipolar line, is triangulated somewhere. Views between and before them tell: they saw it elsewhere.
#pragma once

#include <Eigen/Core>

#include "front_tracker/frame/front_submap.h"

namespace rumi::front_tracker {

// A keypoint of a keyframe, looked for in another one.
struct Twin {
  const Keyframe& keyframe;
  int keypoint = kNone;
};

// Whether the other keyframes near in time, which should see the point where it projects to, show it elsewhere more
// often than there: a keypoint near `a` or `b` that looks like them and like no other, while there is none at the
// projection. `a` is the newer one.
bool is_seen_elsewhere(const FrontSubmap& submap, const Eigen::Vector3d& point, const Twin& a, const Twin& b);

}  // namespace rumi::front_tracker
