// SPDX-License-Identifier: BSD-3-Clause
// Relative pose and structure from two views. Both the essential matrix and the homography are tried (a plane fools the
// one, a general scene the other), every pose that either allows is refined and judged by the points it can
// triangulate, and the answer is refused when the parallax is too small. Two views of a plane often allow two poses:
// both are returned.
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
  double max_rival_ratio = 0.75;  // a pose with this share of the best one's points is another hypothesis
};

struct TwoViewHypothesis {
  SE3 second_from_first;                               // translation of unit length
  std::vector<std::optional<Eigen::Vector3d>> points;  // per match, in the first camera's frame; nothing for outliers
  int inliers = 0;
  double median_parallax_deg = 0;
};

struct TwoViewResult {
  // Different poses that explain the matches about equally well (see max_rival_ratio), the best first. More than one:
  // only a third view can tell which is true.
  std::vector<TwoViewHypothesis> hypotheses;
  std::string refusal;  // why there is none; empty: good
  bool ok() const { return refusal.empty(); }
};

// Matches: undistorted pixels in either view, same length.
TwoViewResult reconstruct_two_views(const Camera& camera, const std::vector<Eigen::Vector2f>& first,
                                    const std::vector<Eigen::Vector2f>& second, const TwoViewOptions& options);

}  // namespace rumi
