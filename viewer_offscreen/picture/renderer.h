// SPDX-License-Identifier: BSD-3-Clause
// Draws a scene: views of the map, the camera's image, a legend, and how the frames were tracked over time.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "viewer_offscreen/canvas/palette.h"
#include "viewer_offscreen/canvas/plot_canvas.h"
#include "viewer_offscreen/picture/layout.h"
#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

class Renderer {
 public:
  // Throws std::runtime_error if there is no OpenGL.
  Renderer();
  // Draws all views, or only one. Returns kPictureWidth x kPictureHeight pixels, 8-bit BGR.
  cv::Mat draw(const Scene& scene, std::optional<ViewKind> only = std::nullopt);

 private:
  PlotCanvas canvas_;
};

}  // namespace rumi::viewer_offscreen
