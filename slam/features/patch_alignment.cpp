// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/patch_alignment.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>

namespace rumi {
namespace {

constexpr std::array<int, 2> kRadii = {7, 4};  // pixels of the level
constexpr int kMaxRadius = kRadii[0];
constexpr int kRows = 2 * kMaxRadius + 1;
constexpr int kColumns = kRows + 1;  // whole vectors; the last column is 0 in every template
constexpr int kWide = kRows + 2;     // with a pixel around, for the slopes
constexpr float kNoise = 5;          // grey levels: standard deviation of a difference, interpolation included
constexpr float kPrior = 0.5F;       // pixels of the level: standard deviation of the place given
constexpr float kMaxShift = 2;       // pixels of the level
constexpr float kMinCorrelation = 0.8F;
constexpr float kMinContrast = 3;          // grey levels: standard deviation within the patch
constexpr float kMinContrastRatio = 0.1F;  // of the image's patch over the template's
constexpr int kIterations = 10;
constexpr float kConverged = 0.03F;  // pixels of the level: a smaller step is the last

using Patch = std::array<float, kRows * kColumns>;
using WidePatch = std::array<float, kWide * kWide>;

// A patch of the reference as it should appear in the image's level.
struct Template {
  int radius = kMaxRadius;             // 0 is what the patches hold beyond it
  Patch grey{}, slope_x{}, slope_y{};  // without mean; the slopes also without what contrast explains
  float norm2 = 0;                     // of grey
  float pixels() const { return static_cast<float>((2 * radius + 1) * (2 * radius + 1)); }
  Eigen::Matrix2f information;  // sums of the products of the slopes
};

float interpolate(const cv::Mat& image, float x, float y) {
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
  const uchar* row = image.ptr<uchar>(iy) + ix;
  const uchar* next = row + image.step1();
  const float upper = static_cast<float>(row[0]) + fx * static_cast<float>(row[1] - row[0]);
  const float lower = static_cast<float>(next[0]) + fx * static_cast<float>(next[1] - next[0]);
  return upper + fy * (lower - upper);
}

// The level of the reference whose pixels, carried over, are nearest in size to those of the image's level.
int reference_level(const ImagePyramid& reference, float wanted_size) {
  int best = 0;
  for (int i = 1; i < reference.levels(); ++i)
    if (std::abs(std::log(reference.pixel_size(i).x() / wanted_size)) <
        std::abs(std::log(reference.pixel_size(best).x() / wanted_size)))
      best = i;
  return best;
}

// The reference's patch and a pixel around it, sampled where the image's pixels would be; false if it leaves the image.
bool sample_reference(const ImagePyramid& reference, const Eigen::Vector2f& center,
                      const Eigen::Matrix2f& image_from_reference, float image_pixel_size, WidePatch* wide) {
  const float determinant = image_from_reference.determinant();
  if (!(determinant > 1e-2F && determinant < 1e2F)) return false;
  const int level = reference_level(reference, image_pixel_size / std::sqrt(determinant));
  const cv::Mat& image = reference.level(level);
  const Eigen::Array2f size = reference.pixel_size(level).array();
  Eigen::Matrix2f step = image_from_reference.inverse() * image_pixel_size;  // full pixels of the reference
  step.row(0) /= size.x();
  step.row(1) /= size.y();
  const Eigen::Vector2f at = reference.to_level(center, level);
  constexpr int kReach = kMaxRadius + 1;
  const Eigen::Array2f reach = static_cast<float>(kReach) * step.cwiseAbs().rowwise().sum().array();
  if (!((at.array() - reach >= 0).all() && at.x() + reach.x() < static_cast<float>(image.cols - 1) &&
        at.y() + reach.y() < static_cast<float>(image.rows - 1)))
    return false;
  size_t i = 0;
  for (int v = -kReach; v <= kReach; ++v) {
    Eigen::Vector2f p = at + step * Eigen::Vector2f(static_cast<float>(-kReach), static_cast<float>(v));
    for (int u = -kReach; u <= kReach; ++u, p += step.col(0)) (*wide)[i++] = interpolate(image, p.x(), p.y());
  }
  return true;
}

// False if the patch has too little to go by.
bool make_template(const WidePatch& wide, int radius, Template* out) {
  Eigen::Matrix3f products = Eigen::Matrix3f::Zero();  // of grey and slopes
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  const int begin = kMaxRadius - radius, end = kMaxRadius + radius;
  const auto at = [&](int x, int y) {
    const float* p = &wide[(y + 1) * kWide + x + 1];
    return Eigen::Vector3f(p[0], 0.5F * (p[1] - p[-1]), 0.5F * (p[kWide] - p[-kWide]));
  };
  for (int y = begin; y <= end; ++y)
    for (int x = begin; x <= end; ++x) {
      const Eigen::Vector3f v = at(x, y);
      mean += v;
      products += v * v.transpose();
    }
  *out = {};
  out->radius = radius;
  const float n = out->pixels();
  mean /= n;
  products -= n * mean * mean.transpose();
  if (!(products(0, 0) > n * kMinContrast * kMinContrast)) return false;
  const Eigen::Vector2f explained = products.block<2, 1>(1, 0) / products(0, 0);
  out->norm2 = products(0, 0);
  out->information = products.block<2, 2>(1, 1) - products(0, 0) * explained * explained.transpose();
  for (int y = begin; y <= end; ++y)
    for (int x = begin; x <= end; ++x) {
      const Eigen::Vector3f v = at(x, y) - mean;
      const int i = y * kColumns + x;
      out->grey[i] = v[0];
      out->slope_x[i] = v[1] - explained[0] * v[0];
      out->slope_y[i] = v[2] - explained[1] * v[0];
    }
  return true;
}

// Rows of the image's patch at a place between pixels, those within the template's radius, whole vectors: calls
// visit(index into a Patch, four pixels). False, and nothing called, where the patch leaves the image.
template <class Visit>
bool for_patch(const Template& t, const cv::Mat& image, const Eigen::Vector2f& at, Visit visit) {
  const float left = at.x() - kMaxRadius, top = at.y() - kMaxRadius;
  if (!(left >= 0 && top >= 0 && left + kColumns + 1 < static_cast<float>(image.cols) &&
        top + kRows + 1 < static_cast<float>(image.rows)))
    return false;
  const int ix = static_cast<int>(left), iy = static_cast<int>(top);
  const cv::v_float32x4 fx = cv::v_setall_f32(left - static_cast<float>(ix)),
                        fy = cv::v_setall_f32(top - static_cast<float>(iy));
  const auto pixels = [](const uchar* p) {
    alignas(4) uchar four[4];  // OpenCV reads them as one int
    std::memcpy(four, p, sizeof four);
    return cv::v_cvt_f32(cv::v_reinterpret_as_s32(cv::v_load_expand_q(four)));
  };
  constexpr int kVectors = kColumns / cv::v_float32x4::nlanes;
  std::array<cv::v_float32x4, kVectors> above;
  for (int y = kMaxRadius - t.radius; y <= kMaxRadius + t.radius + 1; ++y) {
    const uchar* row = image.ptr<uchar>(iy + y) + ix;
    for (int k = 0; k < kVectors; ++k) {
      const int x = k * cv::v_float32x4::nlanes;
      const cv::v_float32x4 here = pixels(row + x), right = pixels(row + x + 1);
      const cv::v_float32x4 level = cv::v_muladd(fx, right - here, here);
      if (y > kMaxRadius - t.radius) visit((y - 1) * kColumns + x, cv::v_muladd(fy, level - above[k], above[k]));
      above[k] = level;
    }
  }
  return true;
}

// Sums of the products of the image's patch and the template's grey and slopes.
std::optional<Eigen::Vector3f> compare(const Template& t, const cv::Mat& image, const Eigen::Vector2f& at) {
  cv::v_float32x4 grey = cv::v_setzero_f32(), x = grey, y = grey;
  if (!for_patch(t, image, at, [&](int i, const cv::v_float32x4& pixels) {
        grey = cv::v_muladd(pixels, cv::v_load(&t.grey[i]), grey);
        x = cv::v_muladd(pixels, cv::v_load(&t.slope_x[i]), x);
        y = cv::v_muladd(pixels, cv::v_load(&t.slope_y[i]), y);
      }))
    return std::nullopt;
  return Eigen::Vector3f(cv::v_reduce_sum(grey), cv::v_reduce_sum(x), cv::v_reduce_sum(y));
}

// Normalised cross-correlation of the image's patch and the template; 0 where it leaves the image.
float correlation(const Template& t, const cv::Mat& image, const Eigen::Vector2f& at) {
  float sum = 0, squares = 0, product = 0;
  std::array<float, cv::v_float32x4::nlanes> lanes;
  for_patch(t, image, at, [&](int i, const cv::v_float32x4& pixels) {
    cv::v_store(lanes.data(), pixels);
    for (int k = 0; k < static_cast<int>(lanes.size()); ++k) {
      if (std::abs((i + k) % kColumns - kMaxRadius) > t.radius) continue;
      sum += lanes[k];
      squares += lanes[k] * lanes[k];
      product += lanes[k] * t.grey[i + k];
    }
  });
  const float norm2 = squares - sum * sum / t.pixels();
  return norm2 > 0 ? product / std::sqrt(norm2 * t.norm2) : 0;
}

// The place in the image's level, beginning at `start`.
std::optional<Eigen::Vector2f> align(const Template& t, const cv::Mat& image, const Eigen::Vector2f& start) {
  Eigen::Vector2f at = start;
  for (int i = 0; i < kIterations; ++i) {
    const auto sums = compare(t, image, at);
    if (!sums) return std::nullopt;
    const float contrast = sums->x() / t.norm2;
    if (!(contrast > kMinContrastRatio)) return std::nullopt;
    // Differences in units of their noise. The slopes are the template's: its step is the opposite of the place's.
    const float weight = contrast * contrast / (kNoise * kNoise);
    const Eigen::Matrix2f information = weight * t.information + Eigen::Matrix2f::Identity() / (kPrior * kPrior);
    const Eigen::Vector2f gradient = weight / contrast * sums->tail<2>() + (at - start) / (kPrior * kPrior);
    const Eigen::Vector2f step = information.inverse() * gradient;
    at -= step;
    if (!((at - start).norm() <= kMaxShift)) return std::nullopt;
    if (step.norm() < kConverged) break;
    if (i + 1 == kIterations) return std::nullopt;
  }
  if (!(correlation(t, image, at) >= kMinCorrelation)) return std::nullopt;
  return at;
}

}  // namespace

std::optional<Eigen::Vector2f> align_patch(const ImagePyramid& reference_images, const Eigen::Vector2f& reference,
                                           const Eigen::Matrix2f& image_from_reference, const PatchPlace& at) {
  if (at.level >= at.images.levels()) return std::nullopt;
  WidePatch wide;
  if (!sample_reference(reference_images, reference, image_from_reference, at.images.pixel_size(at.level).x(), &wide))
    return std::nullopt;
  const Eigen::Vector2f start = at.images.to_level(at.pixel, at.level);
  Template patch;
  for (const int radius : kRadii) {
    if (!make_template(wide, radius, &patch)) continue;
    if (const auto place = align(patch, at.images.level(at.level), start)) return at.images.to_full(*place, at.level);
  }
  return std::nullopt;
}

}  // namespace rumi
