// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/orb_extractor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/features/keypoint_whitening.h"

namespace rumi {
namespace {

constexpr int kPatchRadius = 15;     // pixels of the level, for the intensity centroid and BRIEF's pattern
constexpr int kClearThreshold = 14;  // grey levels; OrbOptions::fast_threshold is lower, for images with few corners
constexpr float kFastRadius = 3;     // radius that FAST looks at, pixels of the level
constexpr double kPlenty = 2.5;      // clear corners per wanted keypoint from which on faint corners are not needed

// The weights of a patch's pixels in its moments: their coordinates, and 0 outside the circle. The last column is
// always outside: it makes a row 32 pixels long, a whole number of vectors.
struct PatchRow {
  std::array<int16_t, 2 * kPatchRadius + 2> x{}, y{};
};

// Returns the weights by distance from the centre's row.
const std::array<PatchRow, kPatchRadius + 1>& patch_rows() {
  static const std::array<PatchRow, kPatchRadius + 1> rows = [] {
    std::array<PatchRow, kPatchRadius + 1> weights{};
    for (int v = 0; v <= kPatchRadius; ++v) {
      const auto half_width = static_cast<int>(std::lround(std::sqrt(kPatchRadius * kPatchRadius - v * v)));
      for (int u = -half_width; u <= half_width; ++u) {
        weights[v].x[kPatchRadius + u] = static_cast<int16_t>(u);
        weights[v].y[kPatchRadius + u] = static_cast<int16_t>(v);
      }
    }
    return weights;
  }();
  return rows;
}

// Returns the direction from the corner to the intensity centroid of its patch (Rosin 1999; ORB section 3.2).
float centroid_angle(const cv::Mat& image, const cv::Point2f& at) {
  const uchar* left = image.ptr<uchar>(cvRound(at.y)) + cvRound(at.x) - kPatchRadius;
  const auto stride = static_cast<std::ptrdiff_t>(image.step1());
  const std::array<PatchRow, kPatchRadius + 1>& rows = patch_rows();
  const auto pixels = [](const uchar* row) { return cv::v_reinterpret_as_s16(cv::v_load_expand(row)); };
  cv::v_int32x4 m10 = cv::v_setzero_s32(), m01 = cv::v_setzero_s32();
  for (int u = 0; u < static_cast<int>(rows[0].x.size()); u += cv::v_int16x8::nlanes) {
    m10 = cv::v_dotprod(pixels(left + u), cv::v_load(&rows[0].x[u]), m10);
    for (int v = 1; v <= kPatchRadius; ++v) {
      const cv::v_int16x8 below = pixels(left + v * stride + u), above = pixels(left - v * stride + u);
      m10 = cv::v_dotprod(below + above, cv::v_load(&rows[v].x[u]), m10);
      m01 = cv::v_dotprod(below - above, cv::v_load(&rows[v].y[u]), m01);
    }
  }
  return std::atan2(static_cast<float>(cv::v_reduce_sum(m01)), static_cast<float>(cv::v_reduce_sum(m10)));
}

// Returns the indices of the corners, strongest first; equally strong ones keep their order.
std::vector<int> strongest_first(const std::vector<cv::KeyPoint>& corners) {
  constexpr int kStrengths = 256;  // FAST's scores are below this
  const auto rank = [](const cv::KeyPoint& k) { return kStrengths - 1 - static_cast<int>(k.response); };
  std::array<int, kStrengths + 1> next{};
  for (const cv::KeyPoint& k : corners) ++next[rank(k) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<int> order(corners.size());
  for (size_t i = 0; i < corners.size(); ++i) order[next[rank(corners[i])]++] = static_cast<int>(i);
  return order;
}

// Takes the strongest corners of every cell in turns (each cell's best, then each cell's second ...) until there are
// `wanted`.
std::vector<cv::KeyPoint> spread(const std::vector<cv::KeyPoint>& corners, int wanted, int cell_px,
                                 const cv::Size& size) {
  const int columns = size.width / cell_px + 1, rows = size.height / cell_px + 1;
  std::vector<size_t> taken(static_cast<size_t>(columns) * rows, 0);
  std::vector<std::vector<int>> turns;
  for (int i : strongest_first(corners)) {
    const size_t turn =
        taken[static_cast<int>(corners[i].pt.y) / cell_px * columns + static_cast<int>(corners[i].pt.x) / cell_px]++;
    if (turn == turns.size()) turns.emplace_back();
    turns[turn].push_back(i);
  }
  std::vector<cv::KeyPoint> kept;
  for (const std::vector<int>& turn : turns)
    for (int i : turn)
      if (static_cast<int>(kept.size()) < wanted) kept.push_back(corners[i]);
  return kept;
}

// Returns the number of keypoints wanted of each level, in proportion to its area.
std::vector<int> quotas(const OrbOptions& options, int keypoints) {
  const double factor = options.pyramid.scale_factor, ratio = 1.0 / (factor * factor);
  double share = (1 - ratio) / (1 - std::pow(ratio, options.pyramid.levels));
  if (options.pyramid.levels == 1) share = 1;
  std::vector<int> wanted(options.pyramid.levels);
  for (int& n : wanted) {
    n = static_cast<int>(std::lround(keypoints * share));
    share *= ratio;
  }
  return wanted;
}

}  // namespace

OrbExtractor::OrbExtractor(const OrbOptions& options)
    : options_(options),
      lacks_clear_(options.pyramid.levels, false),
      describer_(cv::ORB::create(options.keypoints, static_cast<float>(options.pyramid.scale_factor), 1, kOrbBorder_px,
                                 0, 2, cv::ORB::FAST_SCORE, 2 * kPatchRadius + 1)) {}

// Returns only clear corners if there are plenty: spread() would choose no faint ones, and finding those costs most.
std::vector<cv::KeyPoint> OrbExtractor::find_corners(const cv::Mat& image, int octave, int wanted) {
  const int clear = std::max(kClearThreshold, options_.fast_threshold);
  const auto is_plenty = [&](auto corners) { return static_cast<double>(corners) >= kPlenty * wanted; };
  std::vector<cv::KeyPoint> corners;
  if (!lacks_clear_[octave]) {
    cv::FAST(image, corners, clear, true);
    if (is_plenty(corners.size()) || options_.fast_threshold == clear) return corners;
  }
  cv::FAST(image, corners, options_.fast_threshold, true);
  // The strength of a corner is the highest threshold at which it is one.
  const auto is_faint = [&](const cv::KeyPoint& corner) { return corner.response < static_cast<float>(clear); };
  lacks_clear_[octave] = !is_plenty(std::count_if(corners.begin(), corners.end(), std::not_fn(is_faint)));
  if (!lacks_clear_[octave]) std::erase_if(corners, is_faint);
  return corners;
}

std::vector<cv::KeyPoint> OrbExtractor::detect(const ImagePyramid& pyramid, int octave, int wanted) {
  const cv::Mat& level = pyramid.level(octave);
  const int inset = kOrbBorder_px - 3;  // FAST finds nothing within 3 pixels of the border
  const cv::Rect inner(inset, inset, level.cols - 2 * inset, level.rows - 2 * inset);
  std::vector<cv::KeyPoint> corners = find_corners(level(inner), octave, wanted);
  if (!pyramid.mask().is_everything())
    std::erase_if(corners, [&](const cv::KeyPoint& k) {
      const Eigen::Vector2f at_level(k.pt.x + static_cast<float>(inset), k.pt.y + static_cast<float>(inset));
      return !pyramid.shows_world(pyramid.to_full(at_level, octave), octave, kFastRadius);
    });
  corners = spread(corners, wanted, options_.cell_px, inner.size());
  for (cv::KeyPoint& k : corners) {
    k.pt += cv::Point2f(static_cast<float>(inset), static_cast<float>(inset));
    k.octave = 0;
    k.size = 2 * kPatchRadius + 1;
    k.angle = centroid_angle(level, k.pt) * static_cast<float>(180.0 / CV_PI);
  }
  return corners;
}

ImagePyramid OrbExtractor::pyramid(const cv::Mat& grey, const ImageMask& mask) const {
  return {grey, options_.pyramid.scales(), mask};
}

Features OrbExtractor::extract(const ImagePyramid& pyramid, int keypoints) {
  Features features;
  const std::vector<int> wanted = quotas(options_, keypoints > 0 ? keypoints : options_.keypoints);
  for (int octave = 0; octave < pyramid.levels(); ++octave) {
    const cv::Mat& level = pyramid.level(octave);
    if (std::min(level.cols, level.rows) < 2 * kOrbBorder_px + 8) break;
    std::vector<cv::KeyPoint> corners = detect(pyramid, octave, wanted[octave]);
    if (corners.empty()) continue;
    cv::Mat descriptors;
    describer_->compute(level, corners, descriptors);
    for (size_t i = 0; i < corners.size(); ++i) {
      features.keypoints.push_back({pyramid.to_full({corners[i].pt.x, corners[i].pt.y}, octave),
                                    corners[i].angle * static_cast<float>(CV_PI / 180.0),
                                    static_cast<uint8_t>(octave)});
      features.whitenings.push_back(keypoint_whitening(level, corners[i].pt));
      std::memcpy(features.descriptors.emplace_back().data(), descriptors.ptr(static_cast<int>(i)), sizeof(Descriptor));
    }
  }
  return features;
}

}  // namespace rumi
