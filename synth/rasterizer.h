// SPDX-License-Identifier: BSD-3-Clause
// Draws a mesh with OpenGL as an ideal pinhole camera sees it.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "slam/geometry/camera.h"
#include "synth/mesh.h"
#include "viewer_offscreen/gl/offscreen_context.h"

namespace rumi::synth {

class Rasterizer {
 public:
  // Ignores the camera's distortion. The mesh's textures are handed over to OpenGL and not kept.
  Rasterizer(Mesh mesh, const Camera& pinhole);
  ~Rasterizer();

  // Draws light times texture, before exposure, as 8-bit RGBA. White in full light is 200, so that lamps are not
  // clipped. blankness: 0 draws the room, 1 nothing but one flat brightness.
  void draw(const SE3& cam_from_room, double blankness, cv::Mat* rgba);

 private:
  viewer_offscreen::OffscreenContext context_;
  Camera camera_;
  std::vector<Part> parts_;
  std::vector<Eigen::Vector3d> frustum_;  // normals that point inwards, in the camera's frame
  unsigned program_ = 0, vertex_array_ = 0, vertex_buffer_ = 0, index_buffer_ = 0, texture_ = 0;
};

}  // namespace rumi::synth
