// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/sift_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <optional>

#include "ruminator/matching/opencv_usac.h"

namespace rumi::ruminator {
namespace {

constexpr double kUnit = 512.0 * 512.0;  // squared length of a descriptor
constexpr double kMaxDistance = 0.7;     // largest distance between matched descriptors of unit length
constexpr double kMaxRatio = 0.8;        // largest ratio of that distance to that of the second best
constexpr int kMinMatches = 20;          // a pair with fewer matches is not verified
constexpr int kIterations = 1000;        // most RANSAC iterations
constexpr double kConfidence = 0.9999;
constexpr double kMaxErrorPx = 1.5;  // largest distance from both epipolar lines, sqrt(d1² + d2²)

// ThreadSanitizer excludes clones of functions: the clone to run is chosen before the sanitizer has started.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define RUMI_VECTOR_CLONES __attribute__((target_clones("arch=skylake-avx512", "avx2", "default")))
#else
#define RUMI_VECTOR_CLONES
#endif
// Checks are off, because they make the loop a hundred times slower, and 8-bit values cannot overflow it.
#define RUMI_NO_SANITIZE __attribute__((no_sanitize("address", "undefined")))

using WideDescriptor = std::array<int16_t, 128>;
// Descriptors are processed in blocks of this size, for which the compiler makes vector code for each kind of
// processor.
constexpr int kBlock = 16;
constexpr int kLeast = std::numeric_limits<int>::min();  // less than any inner product
constexpr size_t kBlockBytes = kBlock * sizeof(int);
using Block = int __attribute__((vector_size(kBlockBytes)));

// Memory for blocks is aligned to their size, because the clones for newer processors need more than the 16 bytes to
// which a Block is aligned in the rest of this file.
struct alignas(kBlockBytes) Products {
  Block product;
};

// For a block of descriptors: the nearest descriptors so far in the other image, by inner product and index.
struct alignas(kBlockBytes) Nearest {
  Block product = Block{} + kLeast, index = Block{} - 1;
};

// For one descriptor: the two largest inner products so far, separately for each position in the other image's blocks.
struct alignas(kBlockBytes) TwoBest {
  Block best = Block{} + kLeast, second = Block{} + kLeast;
};

// Computes the inner products of `a`, the descriptor at `index` in its image, with all of `b`, in whole blocks. Nearly
// all the time of matching is spent here.
RUMI_VECTOR_CLONES RUMI_NO_SANITIZE void multiply(const WideDescriptor& a, int index,
                                                  const std::vector<WideDescriptor>& b, Products* products,
                                                  TwoBest* of_a, Nearest* of_b) {
  const WideDescriptor* other = b.data();
  Block best = of_a->best, second = of_a->second;
  for (size_t block = 0; block < b.size() / kBlock; ++block, ++products, ++of_b) {
    Block product;
    for (int k = 0; k < kBlock; ++k, ++other) {
      int sum = 0;
#pragma GCC unroll 16
      for (int i = 0; i < 128; ++i) sum += a[i] * (*other)[i];
      product[k] = sum;
    }
    products->product = product;
    const Block behind = product < best ? product : best;
    second = behind > second ? behind : second;
    best = product > best ? product : best;
    of_b->index = product > of_b->product ? Block{} + index : of_b->index;
    of_b->product = product > of_b->product ? product : of_b->product;
  }
  of_a->best = best;
  of_a->second = second;
}

// Appends zero descriptors, which resemble none, up to a whole number of blocks.
std::vector<WideDescriptor> widen(const SiftFeatures& features, size_t count) {
  std::vector<WideDescriptor> wide((count + kBlock - 1) / kBlock * kBlock, WideDescriptor{});
  for (size_t i = 0; i < count; ++i) std::copy_n(features.descriptors[i].begin(), 128, wide[i].begin());
  return wide;
}

double squared_distance(int product) { return std::max(0.0, 2 - 2.0 * product / kUnit); }

// Returns the inner product of the nearest descriptor; nullopt if it is too far, or the second nearest is about as
// near.
std::optional<int> distinct_best(const TwoBest& two) {
  int best = kLeast, second = kLeast;
  for (int k = 0; k < kBlock; ++k) {
    second = std::max({second, two.second[k], std::min(best, two.best[k])});
    best = std::max(best, two.best[k]);
  }
  const double square = squared_distance(best);
  if (square > kMaxDistance * kMaxDistance) return std::nullopt;
  if (square > kMaxRatio * kMaxRatio * squared_distance(second)) return std::nullopt;
  return best;
}

// Returns how many samples of five find a model with kMinInliers right matches. With fewer right matches the pair is
// refused anyway.
int iterations_for(size_t matches) {
  const double right = std::min(1.0, kMinInliers / static_cast<double>(matches));
  const double needed = std::log(1 - kConfidence) / std::log(1 - std::pow(right, 5) + 1e-12);
  return static_cast<int>(std::clamp(std::ceil(needed), 10.0, static_cast<double>(kIterations)));
}

}  // namespace

IndexPairs match_sift(const SiftFeatures& first, const SiftFeatures& second, int limit) {
  const auto count = [limit](const SiftFeatures& f) {
    return limit > 0 ? std::min<size_t>(f.size(), limit) : f.size();
  };
  const size_t count_a = count(first), count_b = count(second);
  const std::vector<WideDescriptor> a = widen(first, count_a), b = widen(second, count_b);
  std::vector<Nearest> of_b(b.size() / kBlock);
  std::vector<Products> products(b.size() / kBlock);
  std::vector<std::pair<int, int>> candidates;
  for (size_t i = 0; i < count_a; ++i) {
    TwoBest two;
    multiply(a[i], static_cast<int>(i), b, products.data(), &two, of_b.data());
    const std::optional<int> best = distinct_best(two);
    if (!best) continue;
    int j = 0;
    while (products[j / kBlock].product[j % kBlock] != *best) ++j;
    candidates.emplace_back(i, j);
  }
  IndexPairs matches;
  for (const auto& [i, j] : candidates)
    if (of_b[j / kBlock].index[j % kBlock] == i) matches.emplace_back(i, j);
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
    const cv::UsacParams usac = usac_params(
        {.max_distance = kMaxErrorPx, .confidence = kConfidence, .iterations = iterations_for(matches.size())});
    const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
    cv::findEssentialMat(a, b, k, k, cv::noArray(), cv::noArray(), is_inlier, usac);
  } catch (const cv::Exception&) {  // degenerate matches, for example all at one point
    return {};
  }
  IndexPairs inliers;
  for (size_t i = 0; i < is_inlier.size() && i < matches.size(); ++i)
    if (is_inlier[i]) inliers.push_back(matches[i]);
  return static_cast<int>(inliers.size()) < kMinInliers ? IndexPairs() : inliers;
}

}  // namespace rumi::ruminator
