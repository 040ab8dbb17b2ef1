// SPDX-License-Identifier: BSD-3-Clause
// Relative pose and structure from two views. Both the essential matrix and the homography are tried (a plane fools the
// one, a general scene the other), every pose that either allows is judged by the points it can triangulate, and the
// answer is refused when the parallax is too small or another pose explains the matches nearly as well.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi {

struct TwoViewOptions {
  int min_points = 60;        // triangulated with enough parallax
  double max_error_px = 2.0;  // reprojection error of an inlier
  double min_median_parallax_deg = 1.0;
  double max_rival_ratio = 0.75;  // points of the second-best pose over those of the best
};

struct TwoViewResult {
  SE3 second_from_first;                               // translation of unit length
  std::vector<std::optional<Eigen::Vector3d>> points;  // per match, in the first camera's frame; nothing for outliers
  int inliers = 0;
  double median_parallax_deg = 0;
  std::string refusal;  // empty: good
  bool ok() const { return refusal.empty(); }
};

// Matches: undistorted pixels in either view, same length.
TwoViewResult reconstruct_two_views(const Camera& camera, const std::vector<Eigen::Vector2f>& first,
                                    const std::vector<Eigen::Vector2f>& second, const TwoViewOptions& options);

}  // namespace rumi
