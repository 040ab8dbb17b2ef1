// SPDX-License-Identifier: BSD-3-Clause
// Parameters for OpenCV's search for an essential matrix. The meaning of its threshold differs: in OpenCV 4.6 it is the
// distance from both epipolar lines, sqrt(d1² + d2²), in 4.10 the Sampson error, which is half of that if d1 = d2.
#pragma once

#include <opencv2/calib3d.hpp>

namespace rumi::ruminator {

struct EssentialSearch {
  double max_distance = 1.5;  // largest sqrt(d1² + d2²) of an inlier, in the unit of the points
  double confidence = 0.9999;
  int iterations = 2000;
};

inline cv::UsacParams usac_params(const EssentialSearch& search) {
  constexpr bool is_sampson = CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR > 6;
  cv::UsacParams usac;
  usac.confidence = search.confidence;
  usac.maxIterations = search.iterations;
  usac.loMethod = cv::LOCAL_OPTIM_GC;
  usac.score = cv::SCORE_METHOD_MSAC;
  usac.threshold = is_sampson ? search.max_distance / 2 : search.max_distance;
  return usac;
}

}  // namespace rumi::ruminator
