// SPDX-License-Identifier: BSD-3-Clause
// Estimates the intrinsics and one pose per view so that the reprojection error is least.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "slam/geometry/camera.h"

namespace rumi::tool {

// The corners of one view: their places on the board (z = 0) and in the image.
struct CornerPairs {
  std::vector<cv::Point3d> board_mm;
  std::vector<cv::Point2d> pixels;
};

struct LensSolution {
  Camera camera;
  // Standard deviations, from the residuals: fx fy cx cy, then k1 k2 p1 p2 k3 or k1 k2 k3 k4. 0: the parameter was
  // fixed.
  std::vector<double> stddev;
  std::vector<double> view_rms_px;       // of each view: RMS per corner
  std::vector<Eigen::Vector3d> normals;  // normal of the board in each view, in the camera's frame
  double rms_px = 0;
};

// Both functions throw cv::Exception if there is no solution. k3 of a pinhole camera stays 0 if the data cannot tell it
// from 0.
LensSolution solve_pinhole(const std::vector<CornerPairs>& views, cv::Size image);
LensSolution solve_fisheye(const std::vector<CornerPairs>& views, cv::Size image);

// Returns the reprojection error (RMS per corner) of a view in a given camera, with the best pose; -1 if there is no
// pose.
double view_error_px(const Camera& camera, const CornerPairs& view);

}  // namespace rumi::tool
