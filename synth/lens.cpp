// SPDX-License-Identifier: BSD-3-Clause
#include "synth/lens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace rumi::synth {
namespace {

constexpr double kSupersampling = 1.15;  // the pinhole picture is finer by this factor, because the lens resamples it
constexpr int kStock = 1 << 20;

}  // namespace

Lens::Lens(const Camera& camera) : pinhole_(camera) {
  pinhole_.model = Camera::Model::kPinhole;
  pinhole_.k1 = pinhole_.k2 = pinhole_.p1 = pinhole_.p2 = pinhole_.k3 = pinhole_.k4 = 0;
  if (!camera.has_distortion()) return;
  cv::Mat rays(camera.height, camera.width, CV_64FC2);
  double left = 0, right = 0, top = 0, bottom = 0;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.unproject({u, v});
      const auto back = camera.project(ray);
      if (!back || !((*back - Eigen::Vector2d(u, v)).norm() < 0.1))
        throw std::runtime_error(fmt::format(
            "camera: its distortion coefficients cannot be inverted at pixel ({}, {}); check k1, k2, p1, p2, k3", u,
            v));
      rays.at<cv::Vec2d>(v, u) = {ray.x(), ray.y()};
      left = std::min(left, ray.x());
      right = std::max(right, ray.x());
      top = std::min(top, ray.y());
      bottom = std::max(bottom, ray.y());
    }
  if (!(right - left < 8 && bottom - top < 8))
    throw std::runtime_error(fmt::format(
        "camera: its rays reach {:.1f} by {:.1f} (x/z, y/z), too wide to render; give a camera of less than 150 "
        "degrees, or check the distortion coefficients",
        right - left, bottom - top));
  const double f = kSupersampling * std::max(camera.fx, camera.fy);
  pinhole_.fx = pinhole_.fy = f;
  pinhole_.width = static_cast<int>(std::ceil(f * (right - left))) + 4;
  pinhole_.height = static_cast<int>(std::ceil(f * (bottom - top))) + 4;
  pinhole_.cx = 1.5 - f * left;
  pinhole_.cy = 1.5 - f * top;
  if (pinhole_.width > 8192 || pinhole_.height > 8192)
    throw std::runtime_error(
        fmt::format("camera: {}x{} pixels would be needed to render it; give a smaller or narrower one", pinhole_.width,
                    pinhole_.height));
  cv::Mat x(camera.height, camera.width, CV_32F), y(camera.height, camera.width, CV_32F);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const cv::Vec2d& ray = rays.at<cv::Vec2d>(v, u);
      x.at<float>(v, u) = static_cast<float>(f * ray[0] + pinhole_.cx);
      y.at<float>(v, u) = static_cast<float>(f * ray[1] + pinhole_.cy);
    }
  cv::convertMaps(x, y, map_x_, map_y_, CV_16SC2);
}

void Lens::apply(const cv::Mat& ideal, cv::Mat* real) const {
  if (map_x_.empty()) {
    *real = ideal;
  } else {
    cv::remap(ideal, *real, map_x_, map_y_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  }
}

Sensor::Sensor(cv::Size size, int channels, double noise) : vignette_(size, CV_32FC(channels)), noise_(noise) {
  const double reach = std::hypot(size.width, size.height) / 2;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double r = std::hypot(x - size.width / 2.0, y - size.height / 2.0) / reach;
      float* out = vignette_.ptr<float>(y) + static_cast<ptrdiff_t>(x) * channels;
      std::fill(out, out + channels, static_cast<float>(1 - 0.22 * r * r));
    }
  cv::RNG rng(4711);
  normal_.resize(kStock);
  cv::Mat(1, kStock, CV_32F, normal_.data()).setTo(0);
  rng.fill(cv::Mat(1, kStock, CV_32F, normal_.data()), cv::RNG::NORMAL, 0, 1);
}

cv::Mat Sensor::expose(const cv::Mat& image, double gain, uint64_t seed) const {
  cv::Mat out(image.size(), CV_8UC(image.channels()));
  cv::RNG rng(seed * 2654435761u + 12345);
  const int values = image.cols * image.channels();
  const float read2 = static_cast<float>(1.2 * 1.2 * noise_ * noise_),
              shot2 = static_cast<float>(2.2 * 2.2 / 128 * noise_ * noise_);
  for (int y = 0; y < image.rows; ++y) {
    const float* in = image.ptr<float>(y);
    const float* shade = vignette_.ptr<float>(y);
    const float* normal = normal_.data() + rng.uniform(0, kStock - values);
    uint8_t* to = out.ptr<uint8_t>(y);
    for (int i = 0; i < values; ++i) {
      const float light = in[i] * shade[i] * static_cast<float>(gain);
      const float value = light + normal[i] * std::sqrt(read2 + shot2 * light);
      to[i] = static_cast<uint8_t>(std::clamp(value + 0.5f, 0.f, 255.f));
    }
  }
  return out;
}

}  // namespace rumi::synth
