// SPDX-License-Identifier: BSD-3-Clause
// Computes the light of every vertex once, because only the camera moves: lamps with shadows, and ambient light with
// occlusion.
#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>

#include "synth/room.h"

namespace rumi::synth {
namespace {

using Eigen::Vector3d;

constexpr double kReach_m = 0.8;    // distance within which things block ambient light
constexpr double kLampReach_m = 9;  // a lamp that is farther away gives no light

struct Lamp {
  Vector3d at;
  double strength;
};

void place_lamps(const Box& room, std::vector<Lamp>* lamps) {
  const Vector3d size = room.high - room.low;
  const int nx = std::clamp(static_cast<int>(std::lround(size.x() / 3.5)), 1, 5);
  const int ny = std::clamp(static_cast<int>(std::lround(size.y() / 3.5)), 1, 5);
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      const Vector3d offset(size.x() * (i + 0.42 + 0.1 * ((i + j) % 2)) / nx, size.y() * (j + 0.45) / ny,
                            size.z() - 0.25);
      lamps->push_back({room.low + offset, 0.75 + 0.5 * ((3 * i + 5 * j) % 4) / 3.0});
    }
}

// Returns the distance along the unit ray to the box; 1e9 if it misses the box.
double hit(const OccluderBox& box, const Vector3d& from, const Vector3d& direction) {
  const Vector3d o = box.box_from_room * from, d = box.box_from_room.rotation * direction;
  double enter = 0, leave = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(d[axis]) < 1e-9) {
      if (std::abs(o[axis]) > box.half[axis]) return 1e9;
      continue;
    }
    const double a = (-box.half[axis] - o[axis]) / d[axis], b = (box.half[axis] - o[axis]) / d[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter < leave ? enter : 1e9;
}

class Baker {
 public:
  Baker(Mesh& mesh, const RoomShape& shape) : mesh_(mesh), shape_(shape) {
    for (const Box& room : shape.rooms()) place_lamps(room, &lamps_);
    for (int k = 0; k < 14; ++k) {  // rays over the half sphere, denser around its pole (cosine law)
      const double u = (k + 0.5) / 14, angle = k * 2.399963;
      rays_.emplace_back(std::sqrt(u) * std::cos(angle), std::sqrt(u) * std::sin(angle), std::sqrt(1 - u));
    }
  }

  void bake(Part& part) const {
    std::vector<const OccluderBox*> near;
    for (const OccluderBox& box : mesh_.occluders) {
      const Vector3d centre = box.box_from_room.center();
      if ((centre - centre.cwiseMax(part.low).cwiseMin(part.high)).norm() < box.half.norm() + kReach_m)
        near.push_back(&box);
    }
    const Vector3d middle = 0.5 * (part.low + part.high) + Vector3d(0, 0, 0.25 * (part.high.z() - part.low.z()));
    std::vector<std::vector<const OccluderBox*>> between;
    std::vector<double> visible;
    for (const Lamp& lamp : lamps_) {
      between.push_back(boxes_between(part, lamp));
      visible.push_back(part.detailed_light || sees(middle, lamp, between.back()) ? 1 : 0.35);
    }
    for (uint32_t k = part.first_vertex; k < part.first_vertex + part.vertices; ++k) {
      Vertex& vertex = mesh_.vertices[k];
      if (part.glow > 0) {
        vertex.light = part.glow;
        continue;
      }
      const Vector3d normal = mesh_.normals[k].cast<double>();
      const Vector3d at = Eigen::Vector3f(vertex.position).cast<double>() + 0.012 * normal;
      double light = 0.50 * (part.detailed_light ? openness(at, normal, near) : 0.8);
      for (size_t i = 0; i < lamps_.size(); ++i) {
        const Vector3d to = lamps_[i].at - at;
        const double distance = to.norm(), cosine = normal.dot(to) / distance;
        if (cosine <= 0 || distance > kLampReach_m) continue;
        const double shade = part.detailed_light ? (sees(at, lamps_[i], between[i]) ? 1.0 : 0.12) : visible[i];
        light += 0.85 * lamps_[i].strength * shade * std::sqrt(cosine) / (1 + distance * distance / 4);
      }
      vertex.light = static_cast<float>(std::clamp(light, 0.15, 1.25));
    }
  }

 private:
  // Returns the boxes that could throw the lamp's shadow on the part; empty also if the lamp is too far away.
  std::vector<const OccluderBox*> boxes_between(const Part& part, const Lamp& lamp) const {
    std::vector<const OccluderBox*> boxes;
    if ((lamp.at - lamp.at.cwiseMax(part.low).cwiseMin(part.high)).norm() > kLampReach_m) return boxes;
    const Vector3d low = part.low.cwiseMin(lamp.at), high = part.high.cwiseMax(lamp.at);
    for (const OccluderBox& box : mesh_.occluders) {
      const Vector3d centre = box.box_from_room.center();
      if ((centre - centre.cwiseMax(low).cwiseMin(high)).norm() < box.half.norm()) boxes.push_back(&box);
    }
    return boxes;
  }

  static bool sees(const Vector3d& at, const Lamp& lamp, const std::vector<const OccluderBox*>& boxes) {
    const Vector3d to = lamp.at - at;
    const double distance = to.norm();
    if (distance > kLampReach_m) return false;
    return std::none_of(boxes.begin(), boxes.end(),
                        [&](const OccluderBox* box) { return hit(*box, at, to / distance) < distance; });
  }

  // Returns how open the half sphere above a point is: 1 if nothing is within kReach_m, 0.25 if everything is at the
  // point.
  double openness(const Vector3d& at, const Vector3d& normal, const std::vector<const OccluderBox*>& near) const {
    const Eigen::Quaterniond tilt = shortest_turn(Vector3d::UnitZ(), normal);
    double open = 0;
    for (const Vector3d& ray : rays_) {
      const Vector3d direction = tilt * ray;
      double distance = kReach_m;
      for (int axis = 0; axis < 3; ++axis) {  // the walls of the building, too
        const double wall = direction[axis] > 0 ? shape_.high[axis] - at[axis] : at[axis] - shape_.low[axis];
        distance = std::min(distance, std::max(0.0, wall) / std::max(1e-9, std::abs(direction[axis])));
      }
      for (const OccluderBox* box : near) distance = std::min(distance, hit(*box, at, direction));
      open += 0.25 + 0.75 * distance / kReach_m;
    }
    return open / static_cast<double>(rays_.size());
  }

  Mesh& mesh_;
  const RoomShape& shape_;
  std::vector<Lamp> lamps_;
  std::vector<Vector3d> rays_;
};

}  // namespace

void bake_light(Mesh& mesh, const RoomShape& shape) {
  const Baker baker(mesh, shape);
  cv::parallel_for_(cv::Range(0, static_cast<int>(mesh.parts.size())), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) baker.bake(mesh.parts[i]);
  });
}

}  // namespace rumi::synth
