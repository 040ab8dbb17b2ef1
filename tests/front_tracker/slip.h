// SPDX-License-Identifier: BSD-3-Clause
// A submap as a slip of tracking leaves it: its end lies elsewhere than it should.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "front_tracker/frame/front_submap.h"

namespace rumi::testing {
using namespace rumi::front_tracker;

// Keyframes from `utime_us` on, and what no others have seen, are elsewhere than they should be: tracking has slipped.
inline void slip(FrontSubmap* s, int64_t utime_us) {
  const SE3 bent_from_true(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())), {0.3, 0, 0.1});
  const auto is_bent = [&](int id) { return s->map.keyframe(id)->utime_us >= utime_us; };
  for (auto& [id, lm] : s->map.landmarks) {
    for (const Observation& o : std::vector<Observation>(lm.observations))
      if (is_bent(o.keyframe_id) && !is_bent(lm.observations.front().keyframe_id))
        s->map.remove_observation(id, o.keyframe_id);
    if (is_bent(lm.observations.front().keyframe_id)) lm.position = bent_from_true * lm.position;
  }
  for (auto& [id, kf] : s->map.keyframes)
    if (is_bent(id)) kf.cam_from_submap = kf.cam_from_submap * bent_from_true.inverse();
}

}  // namespace rumi::testing
