// SPDX-License-Identifier: BSD-3-Clause
// The effects of a real camera on an ideal picture: lens distortion, vignetting, exposure and sensor noise.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "slam/geometry/camera.h"

namespace rumi::synth {

// An ideal pinhole camera, and how its picture is resampled to give the real camera's picture.
class Lens {
 public:
  // Throws std::runtime_error if the distortion cannot be inverted, or if the lens sees too wide an angle for one
  // pinhole picture.
  explicit Lens(const Camera& camera);
  const Camera& pinhole() const { return pinhole_; }
  void apply(const cv::Mat& ideal, cv::Mat* real) const;

 private:
  Camera pinhole_;
  cv::Mat map_x_, map_y_;  // fixed point, see cv::convertMaps; empty: the real camera has no distortion
};

class Sensor {
 public:
  Sensor(cv::Size size, int channels, double noise);
  // Returns 8 bit. image: CV_32F, 0..255 before exposure. The noise depends only on the seed.
  cv::Mat expose(const cv::Mat& image, double gain, uint64_t seed) const;

 private:
  cv::Mat vignette_;           // factor for each value of an image
  std::vector<float> normal_;  // normally distributed numbers, of which each row of an image takes some
  double noise_;
};

}  // namespace rumi::synth
