// SPDX-License-Identifier: BSD-3-Clause
// The effects that a real camera adds to an ideal picture: lens distortion, vignetting, exposure and sensor noise.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "slam/geometry/camera.h"

namespace rumi::synth {

// An ideal pinhole camera whose picture, sampled along the lens's rays, gives the real camera's picture.
class Lens {
 public:
  // Throws std::runtime_error if the lens sees too wide for one pinhole picture.
  explicit Lens(const Camera& camera);
  const Camera& pinhole() const { return pinhole_; }
  void apply(const cv::Mat& ideal, cv::Mat* real) const;

 private:
  Camera pinhole_;
  cv::Mat map_x_, map_y_;  // fixed point, see cv::convertMaps; empty: the pinhole is the camera itself
};

class Sensor {
 public:
  Sensor(cv::Size size, int channels, double noise);
  // image: CV_32F, 0..255 before exposure. Returns 8 bit. The noise depends on the seed alone.
  cv::Mat expose(const cv::Mat& image, double gain, uint64_t seed) const;

 private:
  cv::Mat vignette_;           // factor per value
  std::vector<float> normal_;  // a stock of normally distributed numbers
  double noise_;
};

}  // namespace rumi::synth
