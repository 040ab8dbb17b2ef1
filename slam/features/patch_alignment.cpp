// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/patch_alignment.h"

#include <Eigen/LU>
#include <cmath>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>

namespace rumi {
namespace {

constexpr int kRadius = PatchTemplate::kRadius, kRows = PatchTemplate::kRows, kColumns = PatchTemplate::kColumns;
constexpr float kNoise = 5;     // standard deviation of a difference in grey levels, interpolation included
constexpr float kPrior = 0.5F;  // standard deviation of the given place, pixels of the level
constexpr float kMaxShift = 2;  // largest distance from the given place, pixels of the level
constexpr float kMinCorrelation = 0.8F;
constexpr float kMinContrastRatio = 0.1F;  // contrast of the image's patch / the template's, at least
constexpr int kIterations = 10;
constexpr float kConverged = 0.03F;  // pixels of the level; the search ends with a smaller step
constexpr float kMiddleGrey = 128;   // subtracted from grey values, so that the sums of squares keep their precision

constexpr int kLanes = cv::v_float32x4::nlanes;
constexpr int kVectors = kColumns / kLanes;

// Compares the image's patch at one place with the template. Their contrast may differ.
struct Comparison {
  float contrast = 0;              // contrast of the image's patch / the template's
  float correlation = 0;           // normalised cross-correlation
  Eigen::Vector2f slope_products;  // sums of the products of the patch's pixels and the template's slopes
};

// Sums of the pixels of the image's patch, and of their products with the template's pixels and slopes.
struct Sums {
  cv::v_float32x4 pixel = cv::v_setzero_f32(), square = pixel, grey = pixel, x = pixel, y = pixel;
  void add(const PatchTemplate& t, int index, const cv::v_float32x4& pixels) {
    pixel += pixels;
    square = cv::v_muladd(pixels, pixels, square);
    grey = cv::v_muladd(pixels, cv::v_load(&t.grey[index]), grey);
    x = cv::v_muladd(pixels, cv::v_load(&t.slope_x[index]), x);
    y = cv::v_muladd(pixels, cv::v_load(&t.slope_y[index]), y);
  }
};

// Returns masks: all bits of a lane are set if its column is within the radius.
std::array<cv::v_float32x4, kVectors> columns_within(int radius) {
  std::array<cv::v_float32x4, kVectors> within;
  for (int k = 0; k < kVectors; ++k) {
    const cv::v_float32x4 column = cv::v_float32x4(0, 1, 2, 3) + cv::v_setall_f32(static_cast<float>(k * kLanes));
    within[k] = cv::v_abs(column - cv::v_setall_f32(kRadius)) <= cv::v_setall_f32(static_cast<float>(radius));
  }
  return within;
}

// Returns the sums for the patch around `at` (pixels of `image`), or nullopt if the patch leaves the image.
std::optional<Sums> sum_up(const PatchTemplate& t, int radius, const cv::Mat& image, const Eigen::Vector2f& at) {
  const float left = at.x() - kRadius, top = at.y() - kRadius;
  if (!(left >= 0 && top >= 0 && left + kColumns + 1 < static_cast<float>(image.cols) &&
        top + kRows + 1 < static_cast<float>(image.rows)))
    return std::nullopt;
  const int ix = static_cast<int>(left), iy = static_cast<int>(top);
  const cv::v_float32x4 fx = cv::v_setall_f32(left - static_cast<float>(ix)),
                        fy = cv::v_setall_f32(top - static_cast<float>(iy)), middle = cv::v_setall_f32(kMiddleGrey);
  const auto pixels = [](const uchar* p) {
    alignas(4) uchar four[4];  // OpenCV reads them as one int
    std::memcpy(four, p, sizeof four);
    return cv::v_cvt_f32(cv::v_reinterpret_as_s32(cv::v_load_expand_q(four)));
  };
  const std::array<cv::v_float32x4, kVectors> within = columns_within(radius);
  const int first = (kRadius - radius) / kLanes, last = (kRadius + radius) / kLanes;
  std::array<cv::v_float32x4, kVectors> above;
  Sums sums;
  for (int y = kRadius - radius; y <= kRadius + radius + 1; ++y) {
    const uchar* row = image.ptr<uchar>(iy + y) + ix;
    for (int k = first; k <= last; ++k) {
      const int x = k * kLanes;
      const cv::v_float32x4 here = pixels(row + x), right = pixels(row + x + 1);
      const cv::v_float32x4 level = cv::v_muladd(fx, right - here, here - middle);
      if (y > kRadius - radius)
        sums.add(t, (y - 1) * kColumns + x, within[k] & cv::v_muladd(fy, level - above[k], above[k]));
      above[k] = level;
    }
  }
  return sums;
}

std::optional<Comparison> compare(const PatchTemplate& t, const PatchTemplate::Fit& fit, const cv::Mat& image,
                                  const Eigen::Vector2f& at) {
  const auto sums = sum_up(t, fit.radius, image, at);
  if (!sums) return std::nullopt;
  const float pixel = cv::v_reduce_sum(sums->pixel);
  const float norm2 = cv::v_reduce_sum(sums->square) - pixel * pixel / fit.pixels();
  const float product = cv::v_reduce_sum(sums->grey) - fit.mean_grey * pixel;
  return Comparison{product / fit.norm2,
                    norm2 > 0 ? product / std::sqrt(norm2 * fit.norm2) : 0,
                    {cv::v_reduce_sum(sums->x) - fit.mean_x * pixel - fit.explained_x * product,
                     cv::v_reduce_sum(sums->y) - fit.mean_y * pixel - fit.explained_y * product}};
}

// Searches from `start`. Returns the patch's place in pixels of `image`, or nullopt if the image does not agree with
// the template.
std::optional<Eigen::Vector2f> align(const PatchTemplate& t, const PatchTemplate::Fit& fit, const cv::Mat& image,
                                     const Eigen::Vector2f& start) {
  Eigen::Vector2f at = start;
  for (int i = 0; i < kIterations; ++i) {
    const auto c = compare(t, fit, image, at);
    if (!c || !(c->contrast > kMinContrastRatio)) return std::nullopt;
    // Differences are in units of their noise. The slopes are the template's, and the template's step is the opposite
    // of the place's step.
    const float weight = c->contrast * c->contrast / (kNoise * kNoise);
    const Eigen::Matrix2f information = weight * fit.information + Eigen::Matrix2f::Identity() / (kPrior * kPrior);
    const Eigen::Vector2f gradient = weight / c->contrast * c->slope_products + (at - start) / (kPrior * kPrior);
    const Eigen::Vector2f step = information.inverse() * gradient;
    at -= step;
    if (!((at - start).norm() <= kMaxShift)) return std::nullopt;
    if (!(step.norm() < kConverged)) continue;
    if (!(c->correlation >= kMinCorrelation)) return std::nullopt;
    return at;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Vector2f> align_patch(const PatchTemplate& reference, const PatchPlace& at) {
  const Eigen::Vector2f start = at.images.to_level(at.pixel, at.level);
  for (const PatchTemplate::Fit& fit : reference.fits) {
    if (!fit.usable) continue;
    if (const auto place = align(reference, fit, at.images.level(at.level), start))
      return at.images.to_full(*place, at.level);
  }
  return std::nullopt;
}

}  // namespace rumi
