// SPDX-License-Identifier: BSD-3-Clause
// Finds the relative pose and the structure of two views. It tries an essential matrix, which a planar scene misleads,
// and a homography, which any other scene misleads. It refines each pose that either allows, and judges it by the
// points that it can triangulate. It refuses if too few points fit or the parallax is too small. Two views of a plane
// often allow two poses: then it returns both.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi {

struct TwoViewOptions {
  int min_points = 60;        // points that a pose must triangulate, at least
  double max_error_px = 2.0;  // largest reprojection error of an inlier
  double min_median_parallax_deg = 1.0;
  double max_rival_ratio = 0.75;  // points of another pose / points of the best pose, from which on it is returned too
};

struct TwoViewHypothesis {
  SE3 second_from_first;                               // translation of unit length
  std::vector<std::optional<Eigen::Vector3d>> points;  // by match, in the first camera's frame; nullopt for outliers
  int inliers = 0;
  double median_parallax_deg = 0;
};

struct TwoViewResult {
  // Different poses that explain the matches about equally well (see max_rival_ratio), the best first. If there is more
  // than one, only a third view can tell which is true.
  std::vector<TwoViewHypothesis> hypotheses;
  std::string refusal;  // reason why there is no pose; empty if there is one
  bool ok() const { return refusal.empty(); }
};

// The matches are pairs of undistorted pixels: first[i] in one view, second[i] in the other.
TwoViewResult reconstruct_two_views(const Camera& camera, const std::vector<Eigen::Vector2f>& first,
                                    const std::vector<Eigen::Vector2f>& second, const TwoViewOptions& options);

}  // namespace rumi
