// SPDX-License-Identifier: BSD-3-Clause
// Bends submaps at their joints: it solves a pose graph over all their keyframes, each with a similarity of its own, so
// that a drift of the scale within a submap is spread along it. This comes before the bundle adjustment, which from so
// far away would stop at a local minimum.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <vector>

#include "map_server/links/joint.h"
#include "map_server/model/map_model.h"

namespace rumi::map_server {

struct MapGraphOptions {
  // Standard deviations of the pose of one keyframe relative to another with which it shares 100 landmarks. They grow
  // as that number falls.
  double sigma_rotation_deg = 0.1;
  double sigma_translation = 0.01;  // of the median depth
  double sigma_log_scale = 0.005;
  int neighbours = 5;  // edges of a keyframe, besides the one to the next in time
  int min_shared_landmarks = 15;
  double max_joint_chi2 = 100;  // median of a link's joints after bending; a link above it is a mistake
};

// The joints of one link. They are right or wrong together.
using LinkJoints = std::vector<KeyframeJoint>;

struct MapGraphReport {
  bool bent = false;                            // false: nothing was changed
  std::vector<std::vector<double>> joint_chi2;  // per link and joint, after bending
  std::vector<bool> is_wrong;                   // per link: true if the others contradict it; such a link has no weight
};

// Moves the keyframes of the submaps, except the anchor's first keyframe. Positions of landmarks that were adjusted
// before follow their keyframes. `may_be_wrong` is called only if links contradict each other.
MapGraphReport bend(const std::vector<LinkJoints>& links, const std::function<bool(size_t link)>& may_be_wrong,
                    SubmapKey anchor, const MapGraphOptions& options, std::map<SubmapKey, PlacedSubmap>* submaps);

}  // namespace rumi::map_server
