// SPDX-License-Identifier: BSD-3-Clause
// Computes how well a frame's pose and the submap's scale at the frame are known.
#pragma once

#include "front_tracker/frame/front_submap.h"

namespace rumi::front_tracker {

// A structure that depends on nothing else: views, and points that only these views observe.
struct FreeStructure {
  struct Sight {
    size_t view = 0;
    double sigma_px = 1;
  };
  struct Point {
    Eigen::Vector3d position;
    std::vector<Sight> sights;
  };
  std::vector<SE3> cam_from_structure;  // by view; at least two
  std::vector<Point> points;
};
// Returns the covariance of the twist in exp(twist) * cam_from_structure of the second view, if the first view is fixed
// and the distance of the two is the unit of length.
Matrix6d second_twist_covariance(const Camera& camera, const FreeStructure& structure);
// Returns the variance of the logarithm of a baseline's length, from the covariance of one of its ends. Both are in the
// same coordinate system.
double log_length_variance(const Eigen::Vector3d& baseline, const Eigen::Matrix3d& position_covariance);
// Returns the covariance of the camera's centre, in the submap.
Eigen::Matrix3d position_covariance(const SE3& cam_from_submap, const Matrix6d& twist_covariance);

// Returns the certainty of a frame with a pose and matches. The epipolar matches of `views` count too.
PoseCertainty certainty_of(const Submap& submap, const std::vector<double>& octave_scales, const Frame& frame,
                           const std::vector<EpipolarView>& views = {});

// Returns the variance of the log scale of landmarks that are made between two keyframes: the variance at the newer
// one, plus that of the logarithm of their baseline's length.
double log_scale_variance_between(const FrontSubmap& submap, int newer_keyframe, int older_keyframe);
// Returns the variance of the logarithm of the distance between two keyframes.
double log_baseline_variance(const FrontSubmap& submap, int keyframe_a, int keyframe_b);

// Returns the sigmas that are published for a frame with a certainty and a reference keyframe; unknown ones without a
// covariance. The frame's covariance takes the landmarks' keyframes as exact, so the covariance of the reference
// keyframe is added. The first keyframes define the submap's coordinate system and are exact.
PoseSigmas sigmas_of(const FrontSubmap& submap, const Frame& frame);

// Stores the certainty of a new keyframe, which is that of its frame. Lowers the log_scale_variance of a landmark that
// it observes if the baseline to the landmark's host determines it better.
void note_certainty(int keyframe_id, const PoseCertainty& certainty, FrontSubmap* submap);

}  // namespace rumi::front_tracker
