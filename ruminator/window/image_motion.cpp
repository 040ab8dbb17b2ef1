// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/image_motion.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "bus/wire/image_codec.h"
#include "slam/numeric/median.h"

namespace rumi::ruminator {
namespace {

constexpr int kMinWidth = 120;  // least width of a reduced image, px
constexpr int kMinSide = 32;    // least width and height of a reduced image for measuring motion, px
constexpr int kCorners = 100;
constexpr double kCornerQuality = 0.01;  // least quality, relative to the best corner
constexpr double kCornerDistance = 6;    // least distance between two corners, px
constexpr int kMinCorners = 12;          // fewer corners that return prove nothing
constexpr double kMinReturned = 0.3;  // least share of corners that return: in an unrelated image a few do so by chance
constexpr float kMaxReturnError = 0.7F;  // px, between a corner and where it returns to
constexpr double kMinEigenvalue = 1e-3;  // Lucas-Kanade's limit: below it noise would count as texture
constexpr double kMinResponse = 0.2;     // least peak of the correlation: few unrelated images reach it
constexpr double kContrastFloor = 100;   // grey levels squared; noise has a variance of this order

int reduction_for(int width) {
  int reduction = 8;
  while (reduction > 1 && width / reduction < kMinWidth) reduction /= 2;
  return reduction;
}

}  // namespace

std::optional<double> motion_of_corners(const cv::Mat& from, const cv::Mat& to) {
  std::vector<cv::Point2f> corners, there, back;
  cv::goodFeaturesToTrack(from, corners, kCorners, kCornerQuality, kCornerDistance);
  if (static_cast<int>(corners.size()) < kMinCorners) return std::nullopt;
  const cv::Size patch(15, 15);
  const int levels = 3;
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 10, 0.03);
  std::vector<cv::Mat> from_pyramid, to_pyramid;
  cv::buildOpticalFlowPyramid(from, from_pyramid, patch, levels);
  cv::buildOpticalFlowPyramid(to, to_pyramid, patch, levels);
  std::vector<uint8_t> found, returned;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(from_pyramid, to_pyramid, corners, there, found, error, patch, levels, until, 0,
                           kMinEigenvalue);
  cv::calcOpticalFlowPyrLK(to_pyramid, from_pyramid, there, back, returned, error, patch, levels, until, 0,
                           kMinEigenvalue);
  std::vector<double> lengths;
  for (size_t i = 0; i < corners.size(); ++i) {
    const cv::Point2f miss = back[i] - corners[i], step = there[i] - corners[i];
    if (!found[i] || !returned[i] || std::hypot(miss.x, miss.y) > kMaxReturnError) continue;
    lengths.push_back(std::hypot(step.x, step.y));
  }
  if (static_cast<double>(lengths.size()) <
      std::max<double>(kMinCorners, kMinReturned * static_cast<double>(corners.size())))
    return std::nullopt;
  return median(&lengths);
}

std::optional<double> motion_of_picture(const cv::Mat& from, const cv::Mat& to) {
  cv::Mat from_float, to_float, window;
  from.convertTo(from_float, CV_32F);
  to.convertTo(to_float, CV_32F);
  cv::createHanningWindow(window, from.size(), CV_32F);
  double response = 0;
  const cv::Point2d step = cv::phaseCorrelate(from_float, to_float, window, &response);
  if (!(response >= kMinResponse)) return std::nullopt;  // the response is NaN for black images
  return std::hypot(step.x, step.y);
}

double sharpness_of(const cv::Mat& grey) {
  cv::Mat fine;
  cv::Laplacian(grey, fine, CV_16S);
  cv::Scalar mean, fine_deviation, deviation;
  cv::meanStdDev(fine, mean, fine_deviation);
  cv::meanStdDev(grey, mean, deviation);
  return fine_deviation[0] * fine_deviation[0] / (deviation[0] * deviation[0] + kContrastFloor);
}

ImageMeasure ImageMotion::measure(const image_t& image) {
  ImageMeasure measure;
  const int reduction = reduction_for(image.width);
  cv::Mat grey = decode_reduced_grey(image, reduction).value_or(cv::Mat());
  if (grey.empty()) return measure;  // so that the next image is compared with the last good one
  measure.sharpness = sharpness_of(grey);
  if (previous_.size() == grey.size() && std::min(grey.cols, grey.rows) >= kMinSide) {
    measure.motion_px = motion_of_corners(previous_, grey);
    if (!measure.motion_px) measure.motion_px = motion_of_picture(previous_, grey);
    if (measure.motion_px) *measure.motion_px *= reduction;
  }
  previous_ = std::move(grey);
  return measure;
}

}  // namespace rumi::ruminator
