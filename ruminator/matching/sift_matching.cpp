// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/sift_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "ruminator/matching/opencv_usac.h"

namespace rumi::ruminator {
namespace {

constexpr double kUnit = 512.0 * 512.0;  // squared length of a descriptor
constexpr double kMaxDistance = 0.7;     // of a match's descriptors, of unit length
constexpr double kMaxRatio = 0.8;        // of that distance to the second best
constexpr int kMinMatches = 20;          // of a pair, for it to be verified
constexpr int kIterations = 1000;        // RANSAC, at most
constexpr double kMaxErrorPx = 1.5;      // from both epipolar lines, sqrt(d1² + d2²)

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define RUMI_VECTOR_CLONES __attribute__((target_clones("arch=skylake-avx512", "avx2", "default")))
#else
#define RUMI_VECTOR_CLONES
#endif
// 8-bit values: nothing can overflow, and checked for it the loop takes a hundred times as long.
#define RUMI_NO_SANITIZE __attribute__((no_sanitize("address", "undefined")))

using WideDescriptor = std::array<int16_t, 128>;

// Nearly all the time of matching goes here. With 16-bit factors the compiler makes vector code of it, for each kind of
// processor.
RUMI_VECTOR_CLONES RUMI_NO_SANITIZE void dot_products(const WideDescriptor& a, const std::vector<WideDescriptor>& b,
                                                      int* products) {
  for (const WideDescriptor& other : b) {
    int sum = 0;
    for (int i = 0; i < 128; ++i) sum += a[i] * other[i];
    *products++ = sum;
  }
}

std::vector<WideDescriptor> widen(const SiftFeatures& features, size_t count) {
  std::vector<WideDescriptor> wide(count);
  for (size_t i = 0; i < count; ++i) std::copy_n(features.descriptors[i].begin(), 128, wide[i].begin());
  return wide;
}

struct Nearest {
  int best = -1;
  int best_dot = std::numeric_limits<int>::min(), second_dot = std::numeric_limits<int>::min();

  void offer(int index, int product) {
    if (product > best_dot) {
      second_dot = best_dot;
      best_dot = product;
      best = index;
    } else if (product > second_dot) {
      second_dot = product;
    }
  }
  bool is_distinct() const {
    const double best_square = squared_distance(best_dot), second_square = squared_distance(second_dot);
    return best >= 0 && best_square <= kMaxDistance * kMaxDistance &&
           best_square <= kMaxRatio * kMaxRatio * second_square;
  }
  static double squared_distance(int product) {
    return product == std::numeric_limits<int>::min() ? 2 : std::max(0.0, 2 - 2 * product / kUnit);
  }
};

}  // namespace

IndexPairs match_sift(const SiftFeatures& first, const SiftFeatures& second, int limit) {
  const auto count = [limit](const SiftFeatures& f) {
    return limit > 0 ? std::min<size_t>(f.size(), limit) : f.size();
  };
  const std::vector<WideDescriptor> a = widen(first, count(first)), b = widen(second, count(second));
  std::vector<Nearest> of_a(a.size()), of_b(b.size());
  std::vector<int> products(b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    dot_products(a[i], b, products.data());
    for (size_t j = 0; j < b.size(); ++j) {
      of_a[i].offer(static_cast<int>(j), products[j]);
      of_b[j].offer(static_cast<int>(i), products[j]);
    }
  }
  IndexPairs matches;
  for (size_t i = 0; i < a.size(); ++i)
    if (of_a[i].is_distinct() && of_b[of_a[i].best].best == static_cast<int>(i))
      matches.emplace_back(static_cast<int>(i), of_a[i].best);
  return matches;
}

IndexPairs verify_matches(const Camera& camera, const SiftFeatures& first, const SiftFeatures& second,
                          const IndexPairs& matches) {
  if (static_cast<int>(matches.size()) < kMinMatches) return {};
  std::vector<cv::Point2d> a, b;
  for (const auto& [i, j] : matches) {
    a.emplace_back(first.undistorted[i].x(), first.undistorted[i].y());
    b.emplace_back(second.undistorted[j].x(), second.undistorted[j].y());
  }
  std::vector<uint8_t> is_inlier;
  try {
    const cv::UsacParams usac =
        usac_params({.max_distance = kMaxErrorPx, .confidence = 0.9999, .iterations = kIterations});
    const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
    cv::findEssentialMat(a, b, k, k, cv::noArray(), cv::noArray(), is_inlier, usac);
  } catch (const cv::Exception&) {  // degenerate matches, e.g. all in one point
    return {};
  }
  IndexPairs inliers;
  for (size_t i = 0; i < is_inlier.size() && i < matches.size(); ++i)
    if (is_inlier[i]) inliers.push_back(matches[i]);
  return static_cast<int>(inliers.size()) < kMinInliers ? IndexPairs() : inliers;
}

}  // namespace rumi::ruminator
