// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/patch_alignment.h"

#include <Eigen/LU>
#include <algorithm>
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
constexpr int kWideColumns = 20;     // whole vectors of them
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

struct Slopes {
  Patch grey, x, y;
};

// A patch of the reference as it should appear in the image's level.
struct Template {
  int radius = kMaxRadius;             // 0 is what the patches hold beyond it
  Patch grey{}, slope_x{}, slope_y{};  // without mean; the slopes also without what contrast explains
  float norm2 = 0;                     // of grey
  float pixels() const { return static_cast<float>((2 * radius + 1) * (2 * radius + 1)); }
  Eigen::Matrix2f information = Eigen::Matrix2f::Zero();  // sums of the products of the slopes
};

constexpr int kLanes = cv::v_float32x4::nlanes;

// Bilinear, at as many places as a vector has lanes; all must have a pixel to the right and below.
void interpolate(const cv::Mat& image, const float* x, const float* y, float* grey) {
  const cv::v_float32x4 px = cv::v_load(x), py = cv::v_load(y);
  const cv::v_int32x4 ix = cv::v_trunc(px), iy = cv::v_trunc(py);
  std::array<int, kLanes> columns, rows;
  cv::v_store(columns.data(), ix);
  cv::v_store(rows.data(), iy);
  std::array<unsigned, kLanes> corners;
  for (int k = 0; k < kLanes; ++k) {
    const uchar* here = image.data + rows[k] * image.step.p[0] + columns[k];
    const uchar* below = here + image.step.p[0];
    corners[k] = here[0] | here[1] << 8 | below[0] << 16 | static_cast<unsigned>(below[1]) << 24;
  }
  const cv::v_uint32x4 all = cv::v_load(corners.data()), byte = cv::v_setall_u32(255);
  const auto corner = [&](const cv::v_uint32x4& shifted) {
    return cv::v_cvt_f32(cv::v_reinterpret_as_s32(shifted & byte));
  };
  const cv::v_float32x4 fx = px - cv::v_cvt_f32(ix), fy = py - cv::v_cvt_f32(iy);
  const cv::v_float32x4 left = corner(all), below = corner(cv::v_shr<16>(all));
  const cv::v_float32x4 upper = cv::v_muladd(fx, corner(cv::v_shr<8>(all)) - left, left);
  const cv::v_float32x4 lower = cv::v_muladd(fx, corner(cv::v_shr<24>(all)) - below, below);
  cv::v_store(grey, cv::v_muladd(fy, lower - upper, upper));
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
  std::array<float, kWideColumns> x, y, grey;
  for (int v = -kReach; v <= kReach; ++v) {
    Eigen::Vector2f p = at + step * Eigen::Vector2f(static_cast<float>(-kReach), static_cast<float>(v));
    for (int u = 0; u < kWide; ++u, p += step.col(0)) {
      x[u] = p.x();
      y[u] = p.y();
    }
    // Whole vectors: the last pixel again where there is none.
    std::fill(x.begin() + kWide, x.end(), x[kWide - 1]);
    std::fill(y.begin() + kWide, y.end(), y[kWide - 1]);
    for (int u = 0; u < kWideColumns; u += kLanes) interpolate(image, &x[u], &y[u], &grey[u]);
    std::copy_n(grey.begin(), kWide, wide->begin() + static_cast<std::ptrdiff_t>(v + kReach) * kWide);
  }
  return true;
}

// Grey values and their slopes; what is in the last column has no meaning.
void find_slopes(const WidePatch& wide, Slopes* out) {
  const cv::v_float32x4 half = cv::v_setall_f32(0.5F);
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; x += kLanes) {
      const float* p = &wide[(y + 1) * kWide + x + 1];
      const int i = y * kColumns + x;
      cv::v_store(&out->grey[i], cv::v_load(p));
      cv::v_store(&out->x[i], half * (cv::v_load(p + 1) - cv::v_load(p - 1)));
      cv::v_store(&out->y[i], half * (cv::v_load(p + kWide) - cv::v_load(p - kWide)));
    }
}

// False if the patch has too little to go by.
bool make_template(const Slopes& slopes, int radius, Template* out) {
  const int begin = kMaxRadius - radius, end = kMaxRadius + radius;
  // Sums of the products of grey and slopes with each other, and with 1.
  cv::v_float32x4 sum_grey = cv::v_setzero_f32(), sum_x = sum_grey, sum_y = sum_grey;
  for (int y = begin; y <= end; ++y)
    for (int i = y * kColumns + begin; i <= y * kColumns + end; ++i) {
      const float grey = slopes.grey[i], x = slopes.x[i], slope_y = slopes.y[i];
      const cv::v_float32x4 v(grey, x, slope_y, 1);
      sum_grey = cv::v_muladd(v, cv::v_setall_f32(grey), sum_grey);
      sum_x = cv::v_muladd(v, cv::v_setall_f32(x), sum_x);
      sum_y = cv::v_muladd(v, cv::v_setall_f32(slope_y), sum_y);
    }
  Eigen::Matrix<float, 4, 3> sums;
  cv::v_store(sums.col(0).data(), sum_grey);
  cv::v_store(sums.col(1).data(), sum_x);
  cv::v_store(sums.col(2).data(), sum_y);
  *out = {};
  out->radius = radius;
  const float n = out->pixels();
  const Eigen::Vector3f mean = sums.row(3).transpose() / n;
  const Eigen::Matrix3f products = sums.topRows<3>() - n * mean * mean.transpose();
  if (!(products(0, 0) > n * kMinContrast * kMinContrast)) return false;
  const Eigen::Vector2f explained = products.block<2, 1>(1, 0) / products(0, 0);
  out->norm2 = products(0, 0);
  out->information = products.block<2, 2>(1, 1) - products(0, 0) * explained * explained.transpose();
  const auto all = [](float value) { return cv::v_setall_f32(value); };
  for (int x = 0; x < kColumns; x += kLanes) {
    // 0 beyond the radius
    const cv::v_float32x4 away = cv::v_abs(cv::v_float32x4(0, 1, 2, 3) + all(static_cast<float>(x - kMaxRadius)));
    const cv::v_float32x4 inside = away <= all(static_cast<float>(radius));
    for (int i = begin * kColumns + x; i < (end + 1) * kColumns; i += kColumns) {
      const cv::v_float32x4 grey = cv::v_load(&slopes.grey[i]) - all(mean[0]);
      cv::v_store(&out->grey[i], inside & grey);
      cv::v_store(&out->slope_x[i], inside & (cv::v_load(&slopes.x[i]) - all(mean[1]) - all(explained[0]) * grey));
      cv::v_store(&out->slope_y[i], inside & (cv::v_load(&slopes.y[i]) - all(mean[2]) - all(explained[1]) * grey));
    }
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
  constexpr int kVectors = kColumns / kLanes;
  std::array<cv::v_float32x4, kVectors> above;
  for (int y = kMaxRadius - t.radius; y <= kMaxRadius + t.radius + 1; ++y) {
    const uchar* row = image.ptr<uchar>(iy + y) + ix;
    for (int k = 0; k < kVectors; ++k) {
      const int x = k * kLanes;
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
  Patch grey;
  if (!for_patch(t, image, at, [&](int i, const cv::v_float32x4& pixels) { cv::v_store(&grey[i], pixels); })) return 0;
  float sum = 0, squares = 0, product = 0;
  for (int y = kMaxRadius - t.radius; y <= kMaxRadius + t.radius; ++y)
    for (int x = kMaxRadius - t.radius; x <= kMaxRadius + t.radius; ++x) {
      const int i = y * kColumns + x;
      sum += grey[i];
      squares += grey[i] * grey[i];
      product += grey[i] * t.grey[i];
    }
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
  Slopes slopes;
  find_slopes(wide, &slopes);
  Template patch;
  for (const int radius : kRadii) {
    if (!make_template(slopes, radius, &patch)) continue;
    if (const auto place = align(patch, at.images.level(at.level), start)) return at.images.to_full(*place, at.level);
  }
  return std::nullopt;
}

}  // namespace rumi
