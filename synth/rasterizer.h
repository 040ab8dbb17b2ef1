// SPDX-License-Identifier: BSD-3-Clause
// Draws a mesh by OpenGL as an ideal pinhole camera sees it.
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
  // The camera's distortion is ignored. The mesh's pictures are handed over to OpenGL and not kept.
  Rasterizer(Mesh mesh, const Camera& pinhole);
  ~Rasterizer();

  // blankness: 0 the room, 1 nothing but one flat brightness. Output RGBA 8 bit, light and textures multiplied, not yet
  // exposed (white is 200, so that lamps are not clipped).
  void draw(const SE3& cam_from_room, double blankness, cv::Mat* rgba);

 private:
  bool in_sight(const Part& part, const SE3& cam_from_room) const;
  viewer_offscreen::OffscreenContext context_;
  Camera camera_;
  std::vector<Part> parts_;
  std::vector<Eigen::Vector3d> frustum_;  // inward normals in the camera's frame
  unsigned program_ = 0, vertex_array_ = 0, vertex_buffer_ = 0, index_buffer_ = 0, texture_ = 0;
};

}  // namespace rumi::synth
