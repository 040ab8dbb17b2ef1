// SPDX-License-Identifier: BSD-3-Clause
// Computes a camera from views of a board: Zhang, "A flexible new technique for camera calibration", PAMI 2000, by
// cv::calibrateCamera, or by cv::fisheye::calibrate for the model of Kannala and Brandt.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "rumi/calibration/board_detector.h"
#include "slam/geometry/camera.h"

namespace rumi::tool {

struct CalibratorOptions {
  size_t min_views = 8;
  size_t max_views = 50;  // the most different ones are used; the time grows with the third power of their number
  // At least min_tilted_views views must be tilted by min_tilt_deg against the mean of all views. Otherwise focal
  // length and distance cannot be told apart.
  double min_tilt_deg = 15;
  int min_tilted_views = 3;
  // A view is left out if its error is this many robust standard deviations (from the median absolute deviation) above
  // the median, and at least outlier_factor times the median.
  double outlier_deviations = 4, outlier_factor = 1.5;
  size_t max_check_views = 50;
  // A calibration that exceeds these is doubtful.
  double max_rms_px = 1;
  double max_focal_stddev = 0.01;  // standard deviation / focal length
};

struct CalibratedParameter {
  const char* name;
  double value, stddev;
};

struct Calibration {
  Camera camera;
  std::vector<CalibratedParameter> parameters;  // the estimated ones, with the standard deviations of their errors
  double rms_px = 0;                            // RMS reprojection error per corner, of the views used
  size_t views = 0, corners = 0;                // that were used for the calibration
  std::vector<std::string> outliers;            // for each view that was left out, its image and error
  // RMS error of views that were not used for the calibration, each with the pose that fits it best.
  double check_rms_px = 0;
  size_t check_views = 0;  // number of these views; 0: there were none
  // Reasons why the calibration should not be relied on; empty if there are none.
  std::vector<std::string> doubts;
};

// Calibrates from the most different views of `taken`, and checks the result with the others of `taken` and with
// `spare`. It depends on these views alone. An Error if the views are too few, too much alike, or fit no camera; it
// says what to do.
Result<Calibration> calibrate(const Board& board, const std::vector<BoardView>& taken,
                              const std::vector<BoardView>& spare, cv::Size image, Camera::Model model,
                              const CalibratorOptions& options);

}  // namespace rumi::tool
