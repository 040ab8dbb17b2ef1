// SPDX-License-Identifier: BSD-3-Clause
// Draws a scene: an oblique view, a view from above, a legend.
#pragma once

#include <opencv2/core/mat.hpp>

#include "viewer_offscreen/plot_canvas.h"
#include "viewer_offscreen/scene.h"

namespace rumi {

inline constexpr int kPictureWidth = 1280, kPictureHeight = 720;

class Renderer {
 public:
  // Throws std::runtime_error if there is no OpenGL.
  Renderer();
  // kPictureWidth x kPictureHeight, 8 bit BGR.
  cv::Mat draw(const Scene& scene);

 private:
  PlotCanvas canvas_;
};

// Of a submap, by its place in Scene::submaps: distinguishable with any colour vision (after Okabe and Ito). R, G, B.
cv::Vec3b submap_color(size_t index);
inline const cv::Vec3b kTruthColor{30, 30, 30}, kLostColor{120, 30, 40};

}  // namespace rumi
