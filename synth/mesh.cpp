// SPDX-License-Identifier: BSD-3-Clause
#include "synth/mesh.h"

#include <algorithm>
#include <cmath>

namespace rumi::synth {
namespace {

void copy_colour(const cv::Vec3b& from, uint8_t* to) {
  for (int c = 0; c < 3; ++c) to[c] = from[c];
  to[3] = 255;
}

}  // namespace

void MeshBuilder::begin_part(bool detailed_light, float glow) {
  Part part;
  part.first_index = static_cast<uint32_t>(mesh_.indices.size());
  part.first_vertex = static_cast<uint32_t>(mesh_.vertices.size());
  part.detailed_light = detailed_light;
  part.glow = glow;
  part.thing = thing_;
  mesh_.parts.push_back(part);
}

uint32_t MeshBuilder::vertex(const Eigen::Vector3d& room, const Eigen::Vector3d& normal,
                             const TextureAtlas::Patch& patch, double u, double v, const Palette& palette) {
  Vertex out{};
  for (int i = 0; i < 3; ++i) out.position[i] = static_cast<float>(room[i]);
  out.uv[0] = static_cast<float>((patch.px.x + u * patch.px.width) / TextureAtlas::kSize);
  out.uv[1] = static_cast<float>((patch.px.y + v * patch.px.height) / TextureAtlas::kSize);
  out.layer = static_cast<float>(patch.layer);
  out.light = 1;
  copy_colour(palette.dark, out.dark);
  copy_colour(palette.light, out.bright);
  copy_colour(palette.accent, out.accent);
  mesh_.vertices.push_back(out);
  mesh_.normals.push_back(normal.cast<float>());
  return static_cast<uint32_t>(mesh_.vertices.size() - 1);
}

TextureAtlas::Patch MeshBuilder::paint_patch(const Look& look, double width_m, double height_m) {
  const double px_per_m = std::min(look.px_per_m, TextureAtlas::kMaxPatch / std::max(width_m, height_m));
  const auto px = [&](double metres) {
    return std::clamp(static_cast<int>(std::floor(metres * px_per_m + 0.5)), 6, TextureAtlas::kMaxPatch);
  };
  return mesh_.atlas.add(paint(look.material, {px(width_m), px(height_m)}, px_per_m, rng));
}

void MeshBuilder::quad(const SE3& room_from_local, const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                       const Eigen::Vector3d& v, const Look& look, double cell_m) {
  const TextureAtlas::Patch patch = paint_patch(look, u.norm(), v.norm());
  const Eigen::Vector3d normal = room_from_local.rotation * v.cross(u).normalized();
  const int nu = std::max(1, static_cast<int>(std::ceil(u.norm() / cell_m)));
  const int nv = std::max(1, static_cast<int>(std::ceil(v.norm() / cell_m)));
  const uint32_t base = static_cast<uint32_t>(mesh_.vertices.size());
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i <= nu; ++i) {
      const double a = double(i) / nu, b = double(j) / nv;
      vertex(room_from_local * (corner + a * u + b * v), normal, patch, a, b, look.palette);
    }
  const uint32_t row = static_cast<uint32_t>(nu) + 1;
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      const uint32_t k = base + static_cast<uint32_t>(j) * row + static_cast<uint32_t>(i);
      for (const uint32_t index : {k, k + 1, k + row, k + row, k + 1, k + row + 1}) mesh_.indices.push_back(index);
    }
}

void MeshBuilder::box(const SE3& room_from_local, const Eigen::Vector3d& center, const Eigen::Vector3d& size,
                      const Look& look, bool underside) {
  const Eigen::Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  const auto at = [&](double a, double b, double c) -> Eigen::Vector3d {
    return center + 0.5 * Eigen::Vector3d(a * size.x(), b * size.y(), c * size.z());
  };
  quad(room_from_local, at(1, 1, 1), -x, -z, look);   // front (+y)
  quad(room_from_local, at(-1, -1, 1), x, -z, look);  // back
  quad(room_from_local, at(-1, 1, 1), -y, -z, look);  // left (-x)
  quad(room_from_local, at(1, -1, 1), y, -z, look);   // right (+x)
  quad(room_from_local, at(-1, 1, 1), x, -y, look);   // top
  if (underside) quad(room_from_local, at(-1, -1, -1), x, y, look);
  if (size.maxCoeff() > 0.2)
    mesh_.occluders.push_back({SE3(Eigen::Quaterniond::Identity(), -center) * room_from_local.inverse(), 0.5 * size});
}

void MeshBuilder::leaf(const SE3& room_from_local, const Eigen::Vector3d& base, const Eigen::Vector3d& along,
                       const Eigen::Vector3d& across, const TextureAtlas::Patch& patch, const Palette& palette) {
  const Eigen::Vector3d droop(0, 0, -0.25 * along.norm());
  struct Corner {
    double a, b;
  };
  // The outline is pointed and droops slightly. The vein is in the middle row of the texture.
  static constexpr Corner kOutline[] = {{0, 0}, {0.3, 0.5}, {0.65, 0.42}, {1, 0}, {0.65, -0.42}, {0.3, -0.5}};
  const Eigen::Vector3d normal = (room_from_local.rotation * along.cross(across)).normalized();
  for (const double side : {1.0, -1.0}) {
    const uint32_t first = static_cast<uint32_t>(mesh_.vertices.size());
    for (const Corner& c : kOutline)
      vertex(room_from_local * (base + c.a * along + c.b * across + c.a * c.a * droop), side * normal, patch, c.a,
             0.5 + c.b, palette);
    for (uint32_t k = 1; k + 1 < 6; ++k)
      for (const uint32_t index : {first, side > 0 ? first + k : first + k + 1, side > 0 ? first + k + 1 : first + k})
        mesh_.indices.push_back(index);
  }
}

namespace {

void set_bounds(const std::vector<Vertex>& vertices, Part* part) {
  part->low.setConstant(1e9);
  part->high.setConstant(-1e9);
  for (uint32_t k = part->first_vertex; k < part->first_vertex + part->vertices; ++k) {
    const Eigen::Vector3d p = Eigen::Vector3f(vertices[k].position).cast<double>();
    part->low = part->low.cwiseMin(p);
    part->high = part->high.cwiseMax(p);
  }
}

// Appends a part of the cell to the mesh.
void append(const Mesh& cell, const Part& part, const SE3& map_from_cell, Mesh* mesh) {
  Part copy = part;
  copy.first_index = static_cast<uint32_t>(mesh->indices.size());
  copy.first_vertex = static_cast<uint32_t>(mesh->vertices.size());
  for (uint32_t k = part.first_vertex; k < part.first_vertex + part.vertices; ++k) {
    Vertex vertex = cell.vertices[k];
    const Eigen::Vector3d at = map_from_cell * Eigen::Vector3f(vertex.position).cast<double>();
    for (int i = 0; i < 3; ++i) vertex.position[i] = static_cast<float>(at[i]);
    mesh->vertices.push_back(vertex);
    mesh->normals.push_back((map_from_cell.rotation * cell.normals[k].cast<double>()).cast<float>());
  }
  for (uint32_t k = part.first_index; k < part.first_index + part.indices; ++k)
    mesh->indices.push_back(cell.indices[k] - part.first_vertex + copy.first_vertex);
  set_bounds(mesh->vertices, &copy);
  mesh->parts.push_back(copy);
}

}  // namespace

Mesh repeat(const Mesh& cell, const std::vector<SE3>& map_from_cell, double alike, uint64_t seed) {
  Mesh mesh;
  mesh.atlas = cell.atlas;
  cv::RNG rng(seed * 7027 + 3);
  int things = 0;
  for (const Part& part : cell.parts) things = std::max(things, part.thing);
  std::vector<std::vector<bool>> has;  // by copy and thing
  for (size_t copy = 0; copy < map_from_cell.size(); ++copy) {
    has.emplace_back(1, true);
    for (int thing = 1; thing <= things; ++thing) has.back().push_back(rng.uniform(0.0, 1.0) < alike);
  }
  // Things are mostly nearer to a camera than walls, so they are drawn first: the things of all copies, then the
  // building.
  for (const Part& part : cell.parts)
    for (size_t copy = 0; copy < map_from_cell.size(); ++copy)
      if (has[copy][static_cast<size_t>(part.thing)]) append(cell, part, map_from_cell[copy], &mesh);
  return mesh;
}

Mesh MeshBuilder::finish() {
  for (size_t i = 0; i < mesh_.parts.size(); ++i) {
    Part& part = mesh_.parts[i];
    const bool last = i + 1 == mesh_.parts.size();
    part.indices =
        (last ? static_cast<uint32_t>(mesh_.indices.size()) : mesh_.parts[i + 1].first_index) - part.first_index;
    part.vertices =
        (last ? static_cast<uint32_t>(mesh_.vertices.size()) : mesh_.parts[i + 1].first_vertex) - part.first_vertex;
    set_bounds(mesh_.vertices, &part);
  }
  return std::move(mesh_);
}

}  // namespace rumi::synth
