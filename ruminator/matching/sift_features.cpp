// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/sift_features.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace rumi::ruminator {
namespace {

constexpr double kContrast = 0.01;  // a quarter of OpenCV's threshold, because images in a gap are blurred or dark
// If an image has fewer keypoints than kFewKeypoints (it is very dark, or blank), this threshold is tried.
constexpr double kLowContrast = 0.004;
constexpr size_t kFewKeypoints = 60;

constexpr float kMaxMargin = 8;  // px; keypoints stay their radius away from masked pixels, but at most this far

// OpenCV's SIFT doubles the image, which takes most of its time. Shrunk to this part first, but not below kLeastSide,
// images of gaps are rebuilt as well (docs/experiments/2026-11-rumination-price.md).
constexpr double kShrink = 0.71;
constexpr double kLeastSide = 340;  // px; a smaller image has no pixel to spare

struct Found {
  std::vector<cv::KeyPoint> keypoints;  // in pixels of the image that was given
  cv::Mat histograms;
};

// A copy of an image, `scale` times as large.
struct ShrunkImage {
  explicit ShrunkImage(const cv::Mat& grey)
      : scale(static_cast<float>(std::clamp(kLeastSide / std::max(grey.cols, grey.rows), kShrink, 1.0))) {
    cv::resize(grey, pixels, {}, scale, scale, cv::INTER_AREA);
  }
  cv::KeyPoint in_original(cv::KeyPoint keypoint) const {
    // The centre of the first pixel is at 0 in both images.
    keypoint.pt = {(keypoint.pt.x + 0.5F) / scale - 0.5F, (keypoint.pt.y + 0.5F) / scale - 0.5F};
    keypoint.size /= scale;
    return keypoint;
  }
  float scale;
  cv::Mat pixels;
};

// Applies the mask before the strongest keypoints are chosen. OpenCV would do so after: then all of them might lie in a
// caption, and none would be left.
Found find_keypoints(const ShrunkImage& image, const ImageMask& mask, double contrast, int most) {
  Found found;
  const bool is_masked = !mask.is_everything();
  const cv::Ptr<cv::SIFT> sift = cv::SIFT::create(is_masked ? 0 : most, 3, contrast);
  if (is_masked) {
    sift->detect(image.pixels, found.keypoints);
    std::erase_if(found.keypoints, [&](const cv::KeyPoint& shrunk) {
      const cv::KeyPoint k = image.in_original(shrunk);
      return !mask.allows({k.pt.x, k.pt.y}, std::min(kMaxMargin, k.size / 2));
    });
    cv::KeyPointsFilter::retainBest(found.keypoints, most);
    if (!found.keypoints.empty()) sift->compute(image.pixels, found.keypoints, found.histograms);
  } else {
    sift->detectAndCompute(image.pixels, cv::noArray(), found.keypoints, found.histograms);
  }
  for (cv::KeyPoint& keypoint : found.keypoints) keypoint = image.in_original(keypoint);
  return found;
}

// Returns the square roots of the L1-normalized histogram. The Euclidean distance of such vectors is the Hellinger
// distance of the histograms.
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

SiftFeatures extract_sift(const cv::Mat& grey, const Camera& camera, int max_keypoints, const ImageMask& mask) {
  const ShrunkImage shrunk(grey);
  Found found = find_keypoints(shrunk, mask, kContrast, max_keypoints);
  if (found.keypoints.size() < kFewKeypoints) found = find_keypoints(shrunk, mask, kLowContrast, max_keypoints);
  const std::vector<cv::KeyPoint>& keypoints = found.keypoints;
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
    features.descriptors.push_back(root_sift(found.histograms.ptr<float>(i)));
  }
  return features;
}

}  // namespace rumi::ruminator
