// SPDX-License-Identifier: BSD-3-Clause
// A camera from views of a board: Zhang, "A flexible new technique for camera calibration", PAMI 2000, by
// cv::calibrateCamera, and cv::fisheye::calibrate for the model of Kannala and Brandt.
#pragma once

#include <string>
#include <vector>

#include "rumi/calibration/board_detector.h"
#include "slam/geometry/camera.h"

namespace rumi::tool {

struct CalibratorOptions {
  size_t min_views = 8;
  size_t max_views = 50;     // the most different ones; time grows with the third power
  double min_tilt_deg = 15;  // against the mean of all views, of at least
  int min_tilted_views = 3;  // so many: else focal length and distance cannot be told apart
  // A view is left out whose error is this many robust standard deviations (from the median absolute deviation) above
  // the median, and at least the factor times it.
  double outlier_deviations = 4, outlier_factor = 1.5;
  size_t max_check_views = 50;
  // Acceptance.
  double max_rms_px = 1;
  double max_focal_stddev = 0.01;  // part of the focal length
};

struct CalibratedParameter {
  const char* name;
  double value, stddev;
};

struct Calibration {
  std::string error;  // empty, or why there is none and what to do
  bool ok() const { return error.empty(); }

  Camera camera;
  std::vector<CalibratedParameter> parameters;  // that were estimated, with the standard deviations of their errors
  double rms_px = 0;                            // reprojection error per corner, of the views used
  size_t views = 0, corners = 0;                // used
  std::vector<std::string> outliers;            // views that were left out: image, and their error
  // Error of views that were not used, with the camera as it is; each has a pose of its own.
  double check_rms_px = 0;
  size_t check_views = 0;  // 0: there were none
  // Why it should not be relied on; empty if nothing.
  std::vector<std::string> doubts;
};

// taken: views to calibrate from; spare: others, to check with. The result depends on these alone.
Calibration calibrate(const Board& board, const std::vector<BoardView>& taken, const std::vector<BoardView>& spare,
                      cv::Size image, Camera::Model model, const CalibratorOptions& options);

}  // namespace rumi::tool
