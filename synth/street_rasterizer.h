// SPDX-License-Identifier: BSD-3-Clause
// Draws a street with OpenGL as an ideal pinhole camera sees it.
#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "slam/geometry/camera.h"
#include "synth/street_mesh.h"
#include "viewer_offscreen/gl/offscreen_context.h"

namespace rumi::synth {

struct StreetPicture {
  StreetMesh mesh;
  Triangles sky;  // around the camera
  std::vector<cv::Mat> layers;
  cv::Mat shadows;  // see StreetLight::map()
  Eigen::Vector2d shadows_low;
  double shadows_cell_m;
};

class StreetRasterizer {
 public:
  // Ignores the camera's distortion. The textures are handed over to OpenGL and not kept.
  StreetRasterizer(StreetPicture picture, const Camera& pinhole);
  ~StreetRasterizer();

  // Draws 8-bit RGBA before exposure. blankness: see Rasterizer::draw().
  void draw(const SE3& cam_from_street, const Triangles& moving, double blankness, cv::Mat* rgba);
  // Returns the mean grey of a small image of the same view, 0..255.
  double brightness(const SE3& cam_from_street, const Triangles& moving);

 private:
  struct Program {
    unsigned id = 0;
    int clip = -1, camera = -1, blankness = -1, haze = -1;
  };
  Program compile(const char* define) const;
  void use(const Program& program, const Eigen::Matrix4d& clip_from_street, const Eigen::Vector3d& camera,
           double blankness, double haze_per_m);
  void draw_all(const SE3& cam_from_street, const Triangles& moving, double blankness);
  void draw_parts(const SE3& cam_from_street, std::initializer_list<DrawnAs> kinds);
  bool in_sight(const StreetPart& part, const SE3& cam_from_street, const Eigen::Vector3d& camera) const;
  unsigned make_buffers(const Triangles* triangles, unsigned* vertex_buffer, unsigned* index_buffer);

  viewer_offscreen::OffscreenContext context_;
  Camera camera_;
  std::vector<StreetPart> parts_;
  std::vector<Eigen::Vector3d> frustum_;  // normals that point inwards, in the camera's frame
  Program solid_, ground_, with_holes_;
  Eigen::Vector4d shadow_map_;  // low corner, and 1 / size of the map of shadows
  unsigned still_ = 0, moving_ = 0, moving_vertices_ = 0, moving_indices_ = 0, sky_ = 0, atlas_ = 0, shadows_ = 0;
  int sky_indices_ = 0;
};

}  // namespace rumi::synth
