// SPDX-License-Identifier: BSD-3-Clause
// Bends submaps at their joints: solves a pose graph over all their keyframes, each with a similarity of its own, so
// that a drift of the scale within a submap is spread along it. This comes before bundle adjustment, which would end in
// a local minimum if it began that far from the solution. Where a submap slipped, hardly anything holds it together.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <vector>

#include "map_server/links/joint.h"
#include "map_server/model/map_model.h"
#include "map_server/model/slips.h"

namespace rumi::map_server {

struct MapGraphOptions {
  // Standard deviations of the relative pose of two keyframes that share 100 landmarks. With fewer they are larger.
  double sigma_rotation_deg = 0.1;
  double sigma_translation = 0.01;  // as a share of the median depth
  double sigma_log_scale = 0.005;
  int neighbours = 5;  // most covisibility edges of a keyframe, besides the one to the next in time
  int min_shared_landmarks = 15;
  double max_joint_chi2 = 100;  // a link is wrong if the median of its joints' chi2 is larger after bending
};

// The joints of one link, which are right or wrong together.
using LinkJoints = std::vector<KeyframeJoint>;

struct MapGraphReport {
  bool bent = false;                            // false: no submap was changed
  std::vector<std::vector<double>> joint_chi2;  // per link and joint, after bending
  std::vector<bool> is_wrong;                   // by link: whether the others contradict it; such a link has no weight
  std::vector<Slip> slips;                      // where submaps were not bent, but broken
};

// Moves the keyframes of the submaps, except the anchor's first keyframe. Landmark positions from an earlier adjustment
// follow their keyframes. `may_be_wrong` is called only if links contradict each other; it says which links may be
// refused.
MapGraphReport bend(const std::vector<LinkJoints>& links, const std::function<bool(size_t link)>& may_be_wrong,
                    SubmapKey anchor, const MapGraphOptions& options, std::map<SubmapKey, PlacedSubmap>* submaps);

}  // namespace rumi::map_server
