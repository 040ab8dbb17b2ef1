// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/patch_template.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/core/hal/intrin.hpp>

namespace rumi {
namespace {

constexpr int kRows = PatchTemplate::kRows, kColumns = PatchTemplate::kColumns;
constexpr std::array<int, 2> kRadii = {PatchTemplate::kRadius, 4};
constexpr int kWide = kRows + 2;   // rows, and columns, of a patch that is one pixel wider on each side, for the slopes
constexpr int kWideColumns = 20;   // kWide, rounded up to a whole number of vectors
constexpr float kMinContrast = 3;  // least standard deviation of a patch's grey values

using WidePatch = std::array<float, kWide * kWide>;

constexpr int kLanes = cv::v_float32x4::nlanes;

// Interpolates bilinearly at one place per lane. Each place must have a pixel to its right and below it.
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

// Returns the level of the reference whose pixels are nearest in size to `wanted_size`, in pixels of the full image.
int reference_level(const ImagePyramid& reference, float wanted_size) {
  int best = 0;
  for (int i = 1; i < reference.levels(); ++i)
    if (std::abs(std::log(reference.pixel_size(i).x() / wanted_size)) <
        std::abs(std::log(reference.pixel_size(best).x() / wanted_size)))
      best = i;
  return best;
}

// Samples the reference's patch at the places of the image's pixels, and one pixel more on each side. Returns false if
// the patch leaves the reference's image or is distorted too much.
bool sample_reference(const ImagePyramid& reference, const Eigen::Vector2f& center,
                      const Eigen::Matrix2f& image_from_reference, float image_pixel_size, WidePatch* wide) {
  const float determinant = image_from_reference.determinant();
  if (!(determinant > 1e-2F && determinant < 1e2F)) return false;
  const int level = reference_level(reference, image_pixel_size / std::sqrt(determinant));
  const cv::Mat& image = reference.level(level);
  const Eigen::Array2f size = reference.pixel_size(level).array();
  Eigen::Matrix2f step = image_from_reference.inverse() * image_pixel_size;  // in pixels of the reference's full image
  step.row(0) /= size.x();
  step.row(1) /= size.y();
  const Eigen::Vector2f at = reference.to_level(center, level);
  constexpr int kReach = PatchTemplate::kRadius + 1;
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
    // Repeats the last pixel to fill the last vector.
    std::fill(x.begin() + kWide, x.end(), x[kWide - 1]);
    std::fill(y.begin() + kWide, y.end(), y[kWide - 1]);
    for (int u = 0; u < kWideColumns; u += kLanes) interpolate(image, &x[u], &y[u], &grey[u]);
    std::copy_n(grey.begin(), kWide, wide->begin() + static_cast<std::ptrdiff_t>(v + kReach) * kWide);
  }
  return true;
}

// Fills grey and the slopes (central differences). The values of the last column have no meaning.
void find_slopes(const WidePatch& wide, PatchTemplate* out) {
  const cv::v_float32x4 half = cv::v_setall_f32(0.5F);
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; x += kLanes) {
      const float* p = &wide[(y + 1) * kWide + x + 1];
      const int i = y * kColumns + x;
      cv::v_store(&out->grey[i], cv::v_load(p));
      cv::v_store(&out->slope_x[i], half * (cv::v_load(p + 1) - cv::v_load(p - 1)));
      cv::v_store(&out->slope_y[i], half * (cv::v_load(p + kWide) - cv::v_load(p - kWide)));
    }
}

PatchTemplate::Fit find_fit(const PatchTemplate& t, int radius) {
  // Sums of the products of grey and slopes with each other, and with 1.
  cv::v_float32x4 sum_grey = cv::v_setzero_f32(), sum_x = sum_grey, sum_y = sum_grey;
  const int begin = PatchTemplate::kRadius - radius, end = PatchTemplate::kRadius + radius;
  for (int y = begin; y <= end; ++y)
    for (int i = y * kColumns + begin; i <= y * kColumns + end; ++i) {
      const float grey = t.grey[i], x = t.slope_x[i], slope_y = t.slope_y[i];
      const cv::v_float32x4 v(grey, x, slope_y, 1);
      sum_grey = cv::v_muladd(v, cv::v_setall_f32(grey), sum_grey);
      sum_x = cv::v_muladd(v, cv::v_setall_f32(x), sum_x);
      sum_y = cv::v_muladd(v, cv::v_setall_f32(slope_y), sum_y);
    }
  Eigen::Matrix<float, 4, 3> sums;
  cv::v_store(sums.col(0).data(), sum_grey);
  cv::v_store(sums.col(1).data(), sum_x);
  cv::v_store(sums.col(2).data(), sum_y);
  PatchTemplate::Fit fit;
  fit.radius = radius;
  const float n = fit.pixels();
  const Eigen::Vector3f mean = sums.row(3).transpose() / n;
  const Eigen::Matrix3f products = sums.topRows<3>() - n * mean * mean.transpose();
  fit.usable = products(0, 0) > n * kMinContrast * kMinContrast;
  if (!fit.usable) return fit;
  const Eigen::Vector2f explained = products.block<2, 1>(1, 0) / products(0, 0);
  fit.mean_grey = mean[0];
  fit.mean_x = mean[1];
  fit.mean_y = mean[2];
  fit.explained_x = explained[0];
  fit.explained_y = explained[1];
  fit.norm2 = products(0, 0);
  fit.information = products.block<2, 2>(1, 1) - products(0, 0) * explained * explained.transpose();
  return fit;
}

}  // namespace

std::optional<PatchTemplate> make_patch_template(const ImagePyramid& reference_images, const Eigen::Vector2f& reference,
                                                 const Eigen::Matrix2f& image_from_reference, float pixel_size) {
  WidePatch wide;
  if (!sample_reference(reference_images, reference, image_from_reference, pixel_size, &wide)) return std::nullopt;
  std::optional<PatchTemplate> t(std::in_place);
  find_slopes(wide, &*t);
  for (size_t i = 0; i < kRadii.size(); ++i) t->fits[i] = find_fit(*t, kRadii[i]);
  return t;
}

}  // namespace rumi
