// SPDX-License-Identifier: BSD-3-Clause
// Bends submaps where their joints ask for it: a pose graph over all their keyframes, each a similarity of its own, so
// that a scale that drifted within a submap is spread along it. Done before the bundle adjustment, which would stop at
// the first wrong answer from so far away.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <vector>

#include "map_server/links/joint.h"
#include "map_server/model/map_model.h"

namespace rumi::map_server {

struct MapGraphOptions {
  // Of the pose of one keyframe relative to another with which it shares 100 landmarks; it grows as their number falls.
  double sigma_rotation_deg = 0.1;
  double sigma_translation = 0.01;  // of the median depth
  double sigma_log_scale = 0.005;
  int neighbours = 5;  // of a keyframe, besides the next one in time
  int min_shared_landmarks = 15;
  double max_joint_chi2 = 100;  // median of a link's joints, after bending; what is farther out is a mistake
};

// The joints of one link: right or wrong together.
using LinkJoints = std::vector<KeyframeJoint>;

struct MapGraphReport {
  bool bent = false;                            // false: nothing was changed
  std::vector<std::vector<double>> joint_chi2;  // per link and joint, after bending
  std::vector<bool> is_wrong;                   // per link: all the others contradict it, and it counted for nothing
};

// Moves the keyframes of the submaps; those of the anchor's first keyframe stays. Positions of landmarks that were
// adjusted before follow their keyframes. `may_be_wrong` is asked only where links contradict each other.
MapGraphReport bend(const std::vector<LinkJoints>& links, const std::function<bool(size_t link)>& may_be_wrong,
                    SubmapKey anchor, const MapGraphOptions& options, std::map<SubmapKey, PlacedSubmap>* submaps);

}  // namespace rumi::map_server
