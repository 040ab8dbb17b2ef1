// SPDX-License-Identifier: BSD-3-Clause
#include "synth/street_mesh.h"

#include <algorithm>
#include <cmath>

namespace rumi::synth {
namespace {

using Eigen::Vector3d;

constexpr double kChunk_m = 40;
constexpr double kLeafSun = 0.6;  // share of the sun that a leaf gets between the others

// The normal of a polygon that is clockwise as seen from its front (Newell's method).
Vector3d normal_of(const std::vector<Vector3d>& corners) {
  Vector3d sum = Vector3d::Zero();
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vector3d a = corners[i] - corners[0], b = corners[(i + 1) % corners.size()] - corners[0];
    sum -= a.cross(b);
  }
  return sum.norm() > 1e-12 ? Vector3d(sum.normalized()) : Vector3d(Vector3d::UnitZ());
}

uint8_t byte(double share) { return static_cast<uint8_t>(std::lround(255 * std::clamp(share, 0.0, 1.0))); }

void copy_colour(const cv::Vec3b& from, uint8_t* to) {
  for (int c = 0; c < 3; ++c) to[c] = from[c];
}

}  // namespace

Face rectangle(const Vector3d& corner, const Vector3d& u, const Vector3d& v, const Surface& surface, bool painted) {
  return {{{corner, 0, 0}, {corner + u, 1, 0}, {corner + u + v, 1, 1}, {corner + v, 0, 1}}, surface, painted};
}

void add_box(const Vector3d& center, const Vector3d& size, const Surface& surface, bool painted, Model* model) {
  const Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  const auto at = [&](double a, double b, double c) -> Vector3d {
    return center + 0.5 * Vector3d(a * size.x(), b * size.y(), c * size.z());
  };
  model->push_back(rectangle(at(1, 1, 1), -x, -z, surface, painted));
  model->push_back(rectangle(at(-1, -1, 1), x, -z, surface, painted));
  model->push_back(rectangle(at(-1, 1, 1), -y, -z, surface, painted));
  model->push_back(rectangle(at(1, -1, 1), y, -z, surface, painted));
  model->push_back(rectangle(at(-1, 1, 1), x, -y, surface, painted));
}

void move_faces(const SE3& to_from_model, size_t first, Model* model) {
  for (size_t i = first; i < model->size(); ++i)
    for (Corner& corner : (*model)[i].corners) corner.at = to_from_model * corner.at;
}

void add_face(const Face& face, const SE3& street_from_model, const Palette* paint, const StreetLight& light,
              Shadow shadow, Triangles* out) {
  std::vector<Vector3d> corners;
  corners.reserve(face.corners.size());
  for (const Corner& corner : face.corners) corners.push_back(street_from_model * corner.at);
  const Vector3d normal = shadow == Shadow::kLeaf ? Vector3d(Vector3d::UnitZ()) : normal_of(corners);
  const double sky = light.sky(normal), sun = light.sun(normal) * (shadow == Shadow::kLeaf ? kLeafSun : 1);
  const Palette& palette = face.painted && paint ? *paint : face.surface.palette;
  const TextureAtlas::Patch& patch = face.surface.patch;
  const uint32_t first = static_cast<uint32_t>(out->vertices.size());
  for (size_t i = 0; i < corners.size(); ++i) {
    Vertex v{};
    for (int k = 0; k < 3; ++k) v.position[k] = static_cast<float>(corners[i][k]);
    v.uv[0] = static_cast<float>((patch.px.x + face.corners[i].u * patch.px.width) / TextureAtlas::kSize);
    v.uv[1] = static_cast<float>((patch.px.y + face.corners[i].v * patch.px.height) / TextureAtlas::kSize);
    v.layer = static_cast<float>(patch.layer);
    v.light = static_cast<float>(sky);
    copy_colour(palette.dark, v.dark);
    copy_colour(palette.light, v.bright);
    copy_colour(palette.accent, v.accent);
    // The alpha bytes, which no colour needs, say how much sun there is, and whether the map of shadows applies.
    const bool baked_away = shadow == Shadow::kBaked && sun > 0 && !light.sees_sun(corners[i] + 0.8 * normal);
    v.dark[3] = byte(baked_away ? 0 : sun / 1.5);
    v.bright[3] = shadow == Shadow::kMap ? 255 : 0;
    out->vertices.push_back(v);
  }
  for (uint32_t k = 1; k + 1 < corners.size(); ++k)
    for (const uint32_t index : {first, first + k, first + k + 1}) out->indices.push_back(index);
}

Triangles& StreetMeshBuilder::chunk(DrawnAs drawn_as, const Vector3d& at) {
  return chunks_[{drawn_as, static_cast<int>(std::floor(at.x() / kChunk_m)),
                  static_cast<int>(std::floor(at.y() / kChunk_m))}];
}

void StreetMeshBuilder::add(const Face& face, DrawnAs drawn_as, Shadow shadow, const SE3& street_from_model,
                            const Palette* paint) {
  add_face(face, street_from_model, paint, light_, shadow,
           &chunk(drawn_as, street_from_model * face.corners.front().at));
}

void StreetMeshBuilder::add(const Model& model, DrawnAs drawn_as, Shadow shadow, const SE3& street_from_model,
                            const Palette* paint) {
  Triangles& to = chunk(drawn_as, street_from_model.translation);
  for (const Face& face : model) add_face(face, street_from_model, paint, light_, shadow, &to);
}

StreetMesh StreetMeshBuilder::finish() {
  StreetMesh mesh;
  for (auto& [key, triangles] : chunks_) {
    StreetPart part{.first_index = static_cast<uint32_t>(mesh.indices.size()),
                    .indices = static_cast<uint32_t>(triangles.indices.size()),
                    .low = Vector3d::Constant(1e9),
                    .high = Vector3d::Constant(-1e9),
                    .drawn_as = std::get<0>(key)};
    const uint32_t first = static_cast<uint32_t>(mesh.vertices.size());
    for (const Vertex& vertex : triangles.vertices) {
      const Vector3d p = Eigen::Vector3f(vertex.position).cast<double>();
      part.low = part.low.cwiseMin(p);
      part.high = part.high.cwiseMax(p);
    }
    mesh.vertices.insert(mesh.vertices.end(), triangles.vertices.begin(), triangles.vertices.end());
    for (const uint32_t index : triangles.indices) mesh.indices.push_back(first + index);
    mesh.parts.push_back(part);
    triangles = {};
  }
  return mesh;
}

SE3 standing(const Vector3d& at, double yaw_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ())), at};
}

}  // namespace rumi::synth
