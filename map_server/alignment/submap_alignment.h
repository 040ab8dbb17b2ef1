// SPDX-License-Identifier: BSD-3-Clause
// How one submap lies in another that was made of some of the same images (paper, section IV.C: initial alignment,
// then eq. 8). Frames and landmarks vote together: every shared keyframe alone proposes a similarity (rotation from the
// two poses, scale from the depths of its common landmarks, translation from the two camera centres), so neither a
// straight path nor a short one leaves anything undetermined; the landmarks decide by reprojection in both directions.
#pragma once

#include <optional>
#include <string>

#include "map_server/alignment/correspondences.h"
#include "slam/geometry/transform.h"
#include "slam/map/submap.h"

namespace rumi::map_server {

constexpr int kMinSharedKeyframes = 2;  // so that what one says can be tried on the other

struct AlignmentOptions {
  int min_landmarks = 40;  // least number of inliers among the common landmarks; a keyframe needs a quarter to propose
  double max_reprojection_px = 4.0;     // largest error of an inlier, in each direction, at octave 0
  double min_inlier_ratio = 0.5;        // least share of inliers among the common landmarks
  double max_sigma_rotation_deg = 0.5;  // largest standard deviations of the result
  double max_sigma_log_scale = 0.03;
};

struct Alignment {
  Sim3 b_from_a;
  int landmarks = 0, landmark_inliers = 0;
  int keyframes = 0, keyframe_inliers = 0;
  double rmse_px = 0;                                  // root mean square error of the inliers, px at octave 0
  double sigma_rotation_deg = 0, sigma_log_scale = 0;  // standard deviations in the direction that is determined worst
  std::vector<char> inlier;                            // for each of Correspondences::landmarks: whether it agrees
  std::vector<char> keyframe_inlier;                   // for each of Correspondences::keyframes: whether it agrees
  std::string doubt;                                   // why the alignment is refused; empty if it is accepted
};

// If the alignment of all is in doubt, tries the part beside a bent end of a front submap (bent_end.h) under the same
// conditions; the keyframes and landmarks of that end then count as not agreeing. If the submaps have too little in
// common for any proposal, only `doubt` and the counts of the result are set.
Alignment align_submaps(const Submap& a, const Submap& b, const Correspondences& common,
                        const AlignmentOptions& options);

}  // namespace rumi::map_server
