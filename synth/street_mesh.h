// SPDX-License-Identifier: BSD-3-Clause
// The triangles of a street, in parts that are drawn or skipped as a whole. Street axes: z up, metres.
#pragma once

#include <map>
#include <tuple>
#include <vector>

#include "synth/mesh.h"
#include "synth/street_light.h"

namespace rumi::synth {

// A picture in its colours.
struct Surface {
  TextureAtlas::Patch patch;
  Palette palette;
};

struct Corner {
  Eigen::Vector3d at;
  double u, v;  // in the picture: 0..1; beyond it, if the picture is a whole layer, which repeats
};

// A polygon: a fan around its first corner, clockwise as seen from its front.
struct Face {
  std::vector<Corner> corners = {};
  Surface surface = {};
  bool painted = false;  // takes the colours that are chosen for a copy of the model
};

// A thing in a frame of its own: x to its front, y to its left, z up, the origin on the ground.
using Model = std::vector<Face>;

// Returns a rectangle. `corner` is the upper left one as seen from the front, `u` leads right and `v` down.
Face rectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
               const Surface& surface, bool painted = false);
// Appends an upright box without its underside.
void add_box(const Eigen::Vector3d& center, const Eigen::Vector3d& size, const Surface& surface, bool painted,
             Model* model);
// Moves the faces from index `first` on.
void move_faces(const SE3& to_from_model, size_t first, Model* model);

// Where a vertex's sunlight comes from.
enum class Shadow {
  kMap,    // the shadow on the ground below it
  kBaked,  // whether it sees the sun itself
  kNone,
  kLeaf,  // none, and the light comes through, from wherever the leaf faces
};

struct Triangles {
  std::vector<Vertex> vertices;
  std::vector<uint32_t> indices;
};
void add_face(const Face& face, const SE3& street_from_model, const Palette* paint, const StreetLight& light,
              Shadow shadow, Triangles* out);

// How things are drawn, and how far away they are seen.
enum class DrawnAs { kGround, kFar, kNear, kSmall, kMarks, kLeaves, kFarLeaves };

struct StreetPart {
  uint32_t first_index = 0, indices = 0;
  Eigen::Vector3d low, high;  // bounding box
  DrawnAs drawn_as;
};

struct StreetMesh {
  std::vector<Vertex> vertices;
  std::vector<uint32_t> indices;
  std::vector<StreetPart> parts;
};

// Collects triangles by their place.
class StreetMeshBuilder {
 public:
  explicit StreetMeshBuilder(const StreetLight& light) : light_(light) {}
  void add(const Face& face, DrawnAs drawn_as, Shadow shadow, const SE3& street_from_model = {},
           const Palette* paint = nullptr);
  void add(const Model& model, DrawnAs drawn_as, Shadow shadow, const SE3& street_from_model,
           const Palette* paint = nullptr);
  StreetMesh finish();

 private:
  Triangles& chunk(DrawnAs drawn_as, const Eigen::Vector3d& at);
  const StreetLight& light_;
  std::map<std::tuple<DrawnAs, int, int>, Triangles> chunks_;
};

// Returns the pose of a thing that stands upright.
SE3 standing(const Eigen::Vector3d& at, double yaw_rad);

}  // namespace rumi::synth
