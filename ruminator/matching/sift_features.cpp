// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/sift_features.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/features2d.hpp>

namespace rumi::ruminator {
namespace {

constexpr double kContrast = 0.01;  // of a keypoint: a quarter of OpenCV's, the images of a gap are blurred or dark
// Of an image with fewer keypoints than kFewKeypoints, in a second try: it is very dark, or blind.
constexpr double kLowContrast = 0.004;
constexpr size_t kFewKeypoints = 60;

// Square roots of the L1-normalized histogram: their Euclidean distance is the Hellinger distance of the histograms.
SiftDescriptor root_sift(const float* histogram) {
  float sum = 0;
  for (int i = 0; i < 128; ++i) sum += histogram[i];
  SiftDescriptor root{};
  if (sum <= 0) return root;
  for (int i = 0; i < 128; ++i)
    root[i] = static_cast<uint8_t>(std::min(255.0f, std::round(512 * std::sqrt(histogram[i] / sum))));
  return root;
}

}  // namespace

SiftFeatures extract_sift(const cv::Mat& grey, const Camera& camera, int max_keypoints) {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat histograms;
  for (const double contrast : {kContrast, kLowContrast}) {
    cv::SIFT::create(max_keypoints, 3, contrast)->detectAndCompute(grey, cv::noArray(), keypoints, histograms);
    if (keypoints.size() >= kFewKeypoints) break;
  }
  std::vector<int> order(keypoints.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return keypoints[a].size > keypoints[b].size; });

  SiftFeatures features;
  for (int i : order) {
    const Eigen::Vector2d pixel =
        camera.undistort({static_cast<double>(keypoints[i].pt.x), static_cast<double>(keypoints[i].pt.y)});
    if (!pixel.allFinite()) continue;
    features.undistorted.push_back(pixel.cast<float>());
    features.scale_px.push_back(keypoints[i].size / 2);
    features.descriptors.push_back(root_sift(histograms.ptr<float>(i)));
  }
  return features;
}

}  // namespace rumi::ruminator
