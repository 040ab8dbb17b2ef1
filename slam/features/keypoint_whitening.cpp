// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/keypoint_whitening.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/hal/intrin.hpp>

namespace rumi {
namespace {

constexpr int kRadius = 4;
constexpr double kCornerRatio = 0.2;  // smaller / larger eigenvalue of the tensor above which the keypoint is a corner
constexpr double kMaxRatio = 6;       // standard deviation along an edge / across it, at most

}  // namespace

Eigen::Matrix2f keypoint_whitening(const cv::Mat& image, const cv::Point2f& at) {
  const uchar* row = image.ptr<uchar>(cvRound(at.y) - kRadius) + cvRound(at.x) - kRadius;
  const auto stride = static_cast<std::ptrdiff_t>(image.step1());
  const auto pixels = [](const uchar* p) { return cv::v_reinterpret_as_s16(cv::v_load_expand(p)); };
  cv::v_int32x4 sum_xx = cv::v_setzero_s32(), sum_xy = sum_xx, sum_yy = sum_xx;
  for (int y = -kRadius; y <= kRadius; ++y, row += stride)
    for (const int shift : {0, 1}) {  // vectors have 8 pixels: the two outermost columns count once, the others twice
      const uchar* p = row + shift;
      const cv::v_int16x8 slope_x = pixels(p + 1) - pixels(p - 1), slope_y = pixels(p + stride) - pixels(p - stride);
      sum_xx = cv::v_dotprod(slope_x, slope_x, sum_xx);
      sum_xy = cv::v_dotprod(slope_x, slope_y, sum_xy);
      sum_yy = cv::v_dotprod(slope_y, slope_y, sum_yy);
    }
  const double xx = cv::v_reduce_sum(sum_xx), xy = cv::v_reduce_sum(sum_xy), yy = cv::v_reduce_sum(sum_yy);
  const double mean = (xx + yy) / 2, difference = std::hypot((xx - yy) / 2, xy);  // eigenvalues: mean +- difference
  if (!(mean - difference < kCornerRatio * (mean + difference))) return Eigen::Matrix2f::Identity();
  const double along = std::max(std::sqrt((mean - difference) / (mean + difference) / kCornerRatio), 1 / kMaxRatio);
  Eigen::Matrix2d across;  // 2 * projection on the direction across the edge - identity
  across << (xx - yy) / 2, xy, xy, (yy - xx) / 2;
  const Eigen::Matrix2d identity = Eigen::Matrix2d::Identity();
  return (along * identity + (1 - along) / 2 * (identity + across / difference)).cast<float>();
}

}  // namespace rumi
