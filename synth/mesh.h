// SPDX-License-Identifier: BSD-3-Clause
// The room as triangles, which are built from painted quads and boxes. Room axes: z up, metres.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slam/geometry/transform.h"
#include "synth/painter.h"
#include "synth/texture_atlas.h"

namespace rumi::synth {

struct Vertex {
  float position[3];
  float uv[2];  // 0..1 in a layer of the atlas
  float layer;
  float light;  // brightness, see bake_light()
  uint8_t dark[4], bright[4], accent[4];
};

// A range of triangles that is drawn or skipped as a whole.
struct Part {
  uint32_t first_index = 0, indices = 0;
  uint32_t first_vertex = 0, vertices = 0;
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  // bounding box
  bool detailed_light = false;  // shadows per vertex; otherwise one shadow value per lamp
  float glow = 0;               // > 0: the part shines by itself with this brightness
  int thing = 0;                // the parts of one thing have the same number; 0: the building itself
};

struct OccluderBox {
  SE3 box_from_room;
  Eigen::Vector3d half;
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<Eigen::Vector3f> normals;
  std::vector<uint32_t> indices;
  std::vector<Part> parts;
  std::vector<OccluderBox> occluders;
  TextureAtlas atlas;
};

// Returns the lit mesh as often as there are copies. Each has the whole building, and a share `alike` of the things.
Mesh repeat(const Mesh& cell, const std::vector<SE3>& map_from_cell, double alike, uint64_t seed);

struct Look {
  Material material;
  Palette palette;
  double px_per_m;
};

class MeshBuilder {
 public:
  MeshBuilder(uint64_t seed, double px_per_m) : rng(seed * 1000003 + 11), px_per_m_(px_per_m) {}

  Look look(Material material) { return {material, random_palette(material, rng), px_per_m_}; }
  // Begins a part. Everything that is added until the next begin_part() belongs to it.
  void begin_part(bool detailed_light = false, float glow = 0);
  // The parts that follow are those of one thing, or of the building.
  void begin_thing() { thing_ = ++things_; }
  void end_things() { thing_ = 0; }
  // `corner` is the upper left corner as seen from the front, `u` leads right and `v` down (metres). The quad is split
  // into cells of at most cell_m, so that the light can vary within it.
  void quad(const SE3& room_from_local, const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
            const Eigen::Vector3d& v, const Look& look, double cell_m = 0.25);
  // Adds an upright box around `center`. Its underside is drawn only if `underside` is true.
  void box(const SE3& room_from_local, const Eigen::Vector3d& center, const Eigen::Vector3d& size, const Look& look,
           bool underside = false);
  // Adds a leaf from `base` along `along`, as wide as `across`, which is visible from both sides.
  void leaf(const SE3& room_from_local, const Eigen::Vector3d& base, const Eigen::Vector3d& along,
            const Eigen::Vector3d& across, const TextureAtlas::Patch& patch, const Palette& palette);
  TextureAtlas::Patch paint_patch(const Look& look, double width_m, double height_m);
  Mesh finish();

  cv::RNG rng;
  double uniform(double low, double high) { return rng.uniform(low, high); }

 private:
  uint32_t vertex(const Eigen::Vector3d& room, const Eigen::Vector3d& normal, const TextureAtlas::Patch& patch,
                  double u, double v, const Palette& palette);
  Mesh mesh_;
  double px_per_m_;
  int thing_ = 0, things_ = 0;
};

}  // namespace rumi::synth
