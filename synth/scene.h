// SPDX-License-Identifier: BSD-3-Clause
// A room or a street, which a sequence shows.
#pragma once

#include <opencv2/core/mat.hpp>

#include "slam/geometry/transform.h"

namespace rumi::synth {

struct Moment {
  SE3 map_from_cam;
  double time_s = 0;
  double blankness = 0;  // see Rasterizer::draw()
  double lorry = -1;     // 0..1: how much of the passage of a lorry is over; otherwise there is none
};

class Scene {
 public:
  virtual ~Scene() = default;
  // Draws an ideal pinhole picture before exposure, as 8-bit RGBA.
  virtual void draw(const Moment& moment, cv::Mat* rgba) = 0;
  // Returns the factor of an automatic exposure at that time.
  virtual double gain(double) { return 1; }
  // For motion blur: the distance of most things, and how far the picture moves for each further image, pixels.
  virtual double typical_depth_m() const = 0;
  virtual double blur_step_px() const = 0;
};

}  // namespace rumi::synth
