// SPDX-License-Identifier: BSD-3-Clause
// Bends the end of a submap, as a slip of tracking does.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <vector>

#include "front_tracker/frame/front_submap.h"

namespace rumi::testing {
using namespace rumi::front_tracker;

// Moves the keyframes from `utime_us` on, and landmarks that only they observe, to a wrong place, as if tracking had
// slipped.
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

// Appends the keyframes of `end` with times a second later and with landmarks of their own, so that they share none
// with the keyframes already there.
inline void append(const FrontSubmap& end, FrontSubmap* s) {
  std::map<int, int> id_of;
  for (const auto& [id, kf] : end.map.keyframes) {
    Frame frame;
    frame.utime_us = kf.utime_us + 1'000'000;
    frame.features = kf.features;
    frame.cam_from_submap = kf.cam_from_submap;
    frame.clear_matches();
    const int added = s->add_keyframe(&frame).id;
    for (size_t i = 0; i < kf.landmark_ids.size(); ++i) {
      const int theirs = kf.landmark_ids[i];
      if (theirs == kNone) continue;
      if (!id_of.contains(theirs)) id_of[theirs] = s->add_landmark(end.map.landmark(theirs)->position).id;
      s->map.add_observation(id_of[theirs], added, static_cast<int>(i));
    }
  }
}

}  // namespace rumi::testing
