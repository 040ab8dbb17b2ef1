// SPDX-License-Identifier: BSD-3-Clause
// Intrinsics and one pose per view that minimize the reprojection error.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "slam/geometry/camera.h"

namespace rumi::tool {

// Corners of one view: where they are on the board (z = 0) and in the image.
struct CornerPairs {
  std::vector<cv::Point3d> board_mm;
  std::vector<cv::Point2d> pixels;
};

struct LensSolution {
  Camera camera;
  // Standard deviations of fx fy cx cy and then k1 k2 p1 p2 k3 or k1 k2 k3 k4, from the residuals; 0: it was fixed.
  std::vector<double> stddev;
  std::vector<double> view_rms_px;       // per corner
  std::vector<Eigen::Vector3d> normals;  // of the board in each view, in the camera's frame
  double rms_px = 0;
};

// k3 stays 0 if the data cannot tell it from 0. Throws cv::Exception if there is no solution.
LensSolution solve_pinhole(const std::vector<CornerPairs>& views, cv::Size image);
LensSolution solve_fisheye(const std::vector<CornerPairs>& views, cv::Size image);

// Reprojection error of a view with a given camera and the best pose: root mean square per corner; negative if there is
// no pose.
double view_error_px(const Camera& camera, const CornerPairs& view);

}  // namespace rumi::tool
