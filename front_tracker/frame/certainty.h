// SPDX-License-Identifier: BSD-3-Clause
// How well a frame's pose, and the submap's scale where it is, are known.
#pragma once

#include "front_tracker/frame/front_submap.h"

namespace rumi::front_tracker {

// A structure by itself: views, and points that nothing but they tell of.
struct FreeStructure {
  struct Sight {
    size_t view = 0;
    double sigma_px = 1;
  };
  struct Point {
    Eigen::Vector3d position;
    std::vector<Sight> sights;
  };
  std::vector<SE3> cam_from_structure;  // of each view, at least two
  std::vector<Point> points;
};
// Covariance of the twist in exp(twist) * cam_from_structure of the second view against the first, the distance of the
// two being the unit of length.
Matrix6d second_twist_covariance(const Camera& camera, const FreeStructure& structure);
// Of the distance between two places beside its length, from the covariance of the one, in their frame.
double log_length_variance(const Eigen::Vector3d& baseline, const Eigen::Matrix3d& position_covariance);
// Of the camera's centre, in the submap.
Eigen::Matrix3d position_covariance(const SE3& cam_from_submap, const Matrix6d& twist_covariance);

// Of a frame with a pose and matches; `views` tell of the pose, too.
PoseCertainty certainty_of(const Submap& submap, const std::vector<double>& octave_scales, const Frame& frame,
                           const std::vector<EpipolarView>& views = {});

// The variance that the scale of landmarks has which are made between two keyframes: what the newer one carries, and
// how well the distance between the two is known beside its length.
double log_scale_variance_between(const FrontSubmap& submap, int newer_keyframe, int older_keyframe);
// How well the distance between two keyframes is known beside its length: variance of its logarithm.
double log_baseline_variance(const FrontSubmap& submap, int keyframe_a, int keyframe_b);

// Of a frame with a certainty and a reference keyframe, as it is told to others. Not known without a covariance. A
// landmark's covariance supposes that its keyframes are where they are, but they are known no better than frames are:
// so what was known of the reference keyframe is added. The first ones of a submap say where it is.
PoseSigmas sigmas_of(const FrontSubmap& submap, const Frame& frame);

// Of a new keyframe, with the certainty of its frame: from now on its landmarks are known by it, too.
void note_certainty(int keyframe_id, const PoseCertainty& certainty, FrontSubmap* submap);

}  // namespace rumi::front_tracker
