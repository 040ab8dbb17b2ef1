// SPDX-License-Identifier: BSD-3-Clause
#include "synth/room.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "synth/furniture.h"

namespace rumi::synth {
namespace {

using Eigen::Vector3d;

// Number of texture pixels in all large surfaces together. The walls of larger rooms are coarser.
constexpr double kSurfaceTexels = 30e6;

constexpr double kDoorstep_m = 0.6;  // nothing stands nearer to a doorway than this, on either side

struct Bounds {
  Vector3d low, high;
  bool overlaps(const Bounds& other, double gap) const {
    return ((low.array() - gap) < other.high.array()).all() && ((other.low.array() - gap) < high.array()).all();
  }
  double distance(const Vector3d& p) const { return (p - p.cwiseMax(low).cwiseMin(high)).norm(); }
};

class Furnisher {
 public:
  Furnisher(const RoomShape& shape, uint64_t seed, double focal_px)
      : shape_(shape), b_(seed, object_density(shape, focal_px)), surface_px_per_m_(surface_density(shape, focal_px)) {}

  Mesh build() {
    if (shape_.doorway) add_partition(*shape_.doorway);
    if (shape_.repeats) add_doors(shape_.repeats->doors);
    for (const Box& room : shape_.rooms()) {
      enter(room);
      add_along_walls();
      add_standing();
      add_hanging();
      for (int wall = 0; wall < 4; ++wall)
        if (has_wall(wall)) decorate_wall(wall);
      add_rugs();
    }
    b_.end_things();
    for (const Box& room : shape_.rooms()) {
      enter(room);
      add_shell();
    }
    return b_.finish();
  }

 private:
  void enter(const Box& room) {
    room_ = room;
    size_ = room.high - room.low;
  }
  static double surface_density(const RoomShape& shape, double focal_px) {
    const Vector3d s = shape.high - shape.low;
    const double area = 2 * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x());
    return std::min(0.9 * focal_px, std::sqrt(kSurfaceTexels / area));
  }
  static double object_density(const RoomShape& shape, double focal_px) {
    return std::min(focal_px, 2.5 * surface_density(shape, focal_px));
  }

  // Returns the frame of a wall: origin on the floor in its middle, x to the left of a person who looks at it, y into
  // the room.
  SE3 wall_frame(int wall) const {
    const Vector3d middle = 0.5 * (room_.low + room_.high);
    const Vector3d inward[] = {{0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 0, 0}};
    Vector3d at = middle - 0.5 * inward[wall].cwiseProduct(size_);
    at.z() = room_.low.z();
    return SE3(so3_exp({0, 0, wall * M_PI / 2}), at);
  }
  bool has_wall(int wall) const { return !shape_.repeats || shape_.repeats->walls[wall]; }
  // Returns the doorway's x and z in the frame of a wall; empty if the wall has no doorway.
  cv::Rect2d opening_in(int wall) const {
    if (!shape_.doorway || wall % 2 == 0) return {};
    const Doorway& door = *shape_.doorway;
    const Vector3d p = wall_frame(wall).inverse() * Vector3d(door.at.x(), door.at.y(), room_.low.z());
    if (std::abs(p.y()) > door.wall_m) return {};
    return {p.x() - door.width_m / 2, 0, door.width_m, door.height_m};
  }
  double wall_width(int wall) const { return wall % 2 == 0 ? size_.x() : size_.y(); }

  static Bounds bounds(const SE3& frame, double width, double depth, double height, double z0 = 0) {
    Bounds out{Vector3d::Constant(1e9), Vector3d::Constant(-1e9)};
    for (const double x : {-0.5 * width, 0.5 * width})
      for (const double y : {0.0, depth})
        for (const double z : {z0, z0 + height}) {
          const Vector3d p = frame * Vector3d(x, y, z);
          out.low = out.low.cwiseMin(p);
          out.high = out.high.cwiseMax(p);
        }
    return out;
  }
  double clearance(const Bounds& box) const {
    double nearest = 1e9;
    for (const Vector3d& p : shape_.path) nearest = std::min(nearest, box.distance(p));
    return nearest;
  }
  // Takes the place and returns true if it is free and away from the path.
  bool claim(const SE3& frame, double width, double depth, double height, double z0 = 0) {
    const Bounds box = bounds(frame, width, depth, height, z0);
    if ((box.low.array() < room_.low.array() - 0.02).any() || (box.high.array() > room_.high.array() + 0.02).any())
      return false;
    for (const Bounds& other : taken_)
      if (box.overlaps(other, 0.04)) return false;
    if (clearance(box) < kClearance_m) return false;
    taken_.push_back(box);
    b_.begin_thing();
    return true;
  }
  SE3 at(const SE3& frame, double x, double y, double yaw = 0) const {
    return frame * SE3(so3_exp({0, 0, yaw}), Vector3d(x, y, 0));
  }

  void place_one(const SE3& f, double width, bool at_wall) {
    const double choice = b_.uniform(0, 1), h = size_.z();
    if (at_wall && choice < 0.42) {
      const double depth = b_.uniform(0.26, 0.36), height = std::min(h - 0.15, b_.uniform(1.3, 2.3));
      if (claim(f, width, depth, height)) add_bookcase(b_, f, width, depth, height);
    } else if (choice < (at_wall ? 0.62 : 0.4)) {
      const double depth = b_.uniform(0.55, 0.8), height = b_.uniform(0.6, 0.78), top = b_.uniform(0.12, 0.5);
      if (claim(f, width, depth, height + top)) add_table(b_, f, width, depth, height, top);
    } else if (choice < (at_wall ? 0.78 : 0.5)) {
      const double depth = b_.uniform(0.35, 0.55), height = b_.uniform(0.5, 1.1), top = b_.uniform(0.1, 0.4);
      if (claim(f, width, depth, height + top)) add_cabinet(b_, f, width, depth, height, top);
    } else if (choice < (at_wall ? 0.86 : 0.72)) {
      const double w = b_.uniform(0.35, 0.6), height = b_.uniform(0.3, std::min(1.7, h - 0.3));
      if (claim(f, w, w, height)) add_box_stack(b_, f, w, w, height);
    } else if (choice < 0.88) {
      if (claim(f, 0.45, 0.45, 0.95)) add_chair(b_, f, 0.45, 0.45, 0.95);
    } else if (choice < 0.96) {
      const double w = b_.uniform(0.5, 0.9), height = b_.uniform(0.6, 1.7);
      if (claim(f, w, w, height)) add_plant(b_, f, w, height);
    } else {
      if (claim(f, 0.34, 0.34, 1.6)) add_floor_lamp(b_, f, 0.34, 1.6);
    }
  }

  void add_along_walls() {
    for (int wall = 0; wall < 4; ++wall) {
      if (!has_wall(wall)) continue;
      const SE3 frame = wall_frame(wall);
      const double end = wall_width(wall) / 2 - 0.1;
      for (double x = -end + b_.uniform(0, 0.3); x < end - 0.5;) {
        const double width = std::min(b_.uniform(0.7, 1.7), end - x);
        place_one(at(frame, x + width / 2, 0.01), width, true);
        x += width + b_.uniform(0.05, 0.5);
      }
    }
  }

  void add_standing() {
    const double area = size_.x() * size_.y();
    for (int tries = static_cast<int>(10 * std::min(area, 300.0)); tries > 0; --tries) {
      const SE3 floor(Eigen::Quaterniond::Identity(), room_.low);
      const double yaw = b_.rng.uniform(0, 4) * M_PI / 2 + b_.uniform(-0.3, 0.3);
      const SE3 f = at(floor, b_.uniform(0.4, size_.x() - 0.4), b_.uniform(0.4, size_.y() - 0.4), yaw);
      if (size_.z() > 3.6 && tries % 5 == 0) {
        const double w = b_.uniform(0.4, 0.8);
        if (claim(f, w, w, size_.z())) add_pillar(b_, f, w, size_.z());
      } else {
        place_one(f, b_.uniform(0.6, 1.5), false);
      }
    }
  }

  // Adds beams, pipes and lamps under the ceiling.
  void add_hanging() {
    const SE3 top(Eigen::Quaterniond::Identity(), Vector3d(room_.low.x(), room_.low.y(), room_.high.z()));
    const Look wood = b_.look(Material::kPlanks), metal = b_.look(Material::kCloth);
    for (double y = b_.uniform(0.5, 1.2); y < size_.y() - 0.3; y += b_.uniform(0.9, 1.8)) {
      const double h = b_.uniform(0.08, 0.2), w = b_.uniform(0.08, 0.2);
      const SE3 f = at(top, size_.x() / 2, y);
      if (!claim(f, size_.x(), w, h, -h)) continue;
      b_.begin_part(true);
      b_.box(f, {0, w / 2, -h / 2}, {size_.x(), w, h}, b_.rng.uniform(0, 3) ? wood : metal, true);
    }
    for (int tries = static_cast<int>(std::min(60.0, size_.x() * size_.y() / 2)); tries > 0; --tries) {
      const SE3 f = at(top, b_.uniform(0.4, size_.x() - 0.4), b_.uniform(0.4, size_.y() - 0.4), b_.uniform(0, 3));
      const double w = b_.uniform(0.25, 0.5), drop = b_.uniform(0.2, 0.45);
      if (!claim(f, w, w, drop, -drop)) continue;
      b_.begin_part(false, 1.05f);
      b_.box(f, {0, w / 2, -drop + 0.1}, {w, w, 0.2}, b_.look(Material::kWallpaper), true);
      b_.begin_part();
      b_.box(f, {0, w / 2, -drop / 2 + 0.1}, {0.02, 0.02, drop - 0.2}, b_.look(Material::kPot));
    }
  }

  // Adds windows, posters, pictures and papers. Furniture may hide them, but they do not overlap each other.
  void decorate_wall(int wall) {
    const SE3 frame = wall_frame(wall);
    const double width = wall_width(wall), height = size_.z();
    const cv::Rect2d opening = opening_in(wall);
    std::vector<cv::Rect2d> used;
    const double area = width * height;
    for (int tries = static_cast<int>(std::min(9 * area, 900.0)); tries > 0; --tries) {
      const bool window = static_cast<double>(used.size()) < 1 + area / 40 && wall % 2 == 0;
      double w = window ? b_.uniform(0.9, 1.5) : b_.uniform(0.2, 0.9),
             h = window ? b_.uniform(1.0, 1.4) : w * b_.uniform(0.7, 1.5);
      Material material = window ? Material::kWindow : Material::kPoster;
      if (!window && b_.uniform(0, 1) < 0.2) material = Material::kPicture;
      if (!window && b_.uniform(0, 1) < 0.3) {
        material = Material::kPaper;
        w = 0.21;
        h = 0.297;
      }
      if (w > width - 0.3 || h > height - 0.5) continue;
      const cv::Rect2d r(b_.uniform(-width / 2 + 0.1, width / 2 - 0.1 - w), b_.uniform(0.25, height - 0.12 - h), w, h);
      const cv::Rect2d grown(r.x - 0.06, r.y - 0.06, r.width + 0.12, r.height + 0.12);
      if (std::any_of(used.begin(), used.end(), [&](const cv::Rect2d& o) { return (grown & o).area() > 0; })) continue;
      if ((grown & opening).area() > 0) continue;
      used.push_back(r);
      b_.begin_thing();
      b_.begin_part(!window, window ? 1.15f : 0);
      const double relief = material == Material::kPoster || material == Material::kPaper ? 0.004 : 0.02;
      b_.quad(frame, {r.x + w, relief, r.y + h}, {-w, 0, 0}, {0, 0, -h}, b_.look(material));
    }
  }

  void add_rugs() {
    const SE3 floor(Eigen::Quaterniond::Identity(), room_.low);
    std::vector<cv::Rect2d> used;
    for (int tries = static_cast<int>(std::min(40.0, size_.x() * size_.y() / 3)); tries > 0; --tries) {
      const double w = b_.uniform(0.8, 1.8), d = b_.uniform(1.0, 2.4);
      if (w > size_.x() - 1 || d > size_.y() - 1) continue;
      const cv::Rect2d r(b_.uniform(0.3, size_.x() - 0.3 - w), b_.uniform(0.3, size_.y() - 0.3 - d), w, d);
      if (std::any_of(used.begin(), used.end(), [&](const cv::Rect2d& o) { return (r & o).area() > 0; })) continue;
      used.push_back(r);
      b_.begin_thing();
      b_.begin_part(true);
      Look rug = b_.look(Material::kCarpet);
      rug.px_per_m = std::min(rug.px_per_m, 1.5 * surface_px_per_m_);
      b_.quad(floor, {r.x, r.y + d, 0.006}, {w, 0, 0}, {0, -d, 0}, rug);
    }
  }

  // Adds a large rectangle in pieces that fit into the texture atlas.
  void surface(const SE3& frame, const Vector3d& corner, const Vector3d& u, const Vector3d& v, Look look) {
    look.px_per_m = surface_px_per_m_;
    const auto pieces = [&](double metres) {
      return std::max(1, static_cast<int>(std::ceil(metres * surface_px_per_m_ / TextureAtlas::kMaxPatch)));
    };
    const int nu = pieces(u.norm()), nv = pieces(v.norm());
    for (int i = 0; i < nu; ++i)
      for (int j = 0; j < nv; ++j) {
        b_.begin_part(true);
        b_.quad(frame, corner + u * (double(i) / nu) + v * (double(j) / nv), u / nu, v / nv, look,
                std::max(0.2, size_.norm() / 60));
      }
  }

  // Adds the wall between two rooms, in three pieces around its doorway. It is drawn before all else, because from
  // either room it hides the other one.
  void add_partition(const Doorway& door) {
    // The frame's x is the room's y.
    const SE3 frame(so3_exp({0, 0, M_PI / 2}), Vector3d(door.at.x(), door.at.y(), shape_.low.z()));
    const double height = shape_.high.z() - shape_.low.z(), half = door.width_m / 2;
    Look wall = b_.look(Material::kBrick);
    wall.px_per_m = surface_px_per_m_;
    const auto piece = [&](double from, double to, double z0, double z1) {
      b_.begin_part(true);
      b_.box(frame, {0.5 * (from + to), 0, 0.5 * (z0 + z1)}, {to - from, door.wall_m, z1 - z0}, wall, true);
    };
    piece(shape_.low.y() - door.at.y(), -half, 0, height);
    piece(half, shape_.high.y() - door.at.y(), 0, height);
    piece(-half, half, door.height_m, height);
    b_.begin_part(true);
    b_.box(frame, {0, 0, 0.005}, {door.width_m, door.wall_m, 0.01}, b_.look(Material::kWood));  // threshold
    const Vector3d reach(kDoorstep_m, half, 0), middle(door.at.x(), door.at.y(), shape_.low.z());
    taken_.push_back({middle - reach, middle + reach + Vector3d(0, 0, door.height_m)});
  }

  // Adds closed doors. Nothing stands before them.
  void add_doors(const std::array<std::vector<double>, 4>& doors) {
    enter(shape_.rooms().front());
    for (int wall = 0; wall < 4; ++wall)
      for (const double x : doors[wall]) {
        const SE3 frame = at(wall_frame(wall), x, 0.01);
        add_door(b_, frame, 0.95, 0.08, 2.1);
        taken_.push_back(bounds(frame, 1.05, 0.5, 2.2));
      }
  }

  // Adds walls, floor and ceiling. They come last: things before them are drawn first and hide their pixels.
  void add_shell() {
    const Material walls[] = {Material::kBrick, Material::kWallpaper, Material::kPlaster, Material::kPanelling,
                              Material::kStone};
    const int first = b_.rng.uniform(0, 5);
    for (int wall = 0; wall < 4; ++wall) {
      if (!has_wall(wall) || !opening_in(wall).empty()) continue;  // add_partition() has built the latter
      const double w = wall_width(wall), h = size_.z();
      surface(wall_frame(wall), {w / 2, 0, h}, {-w, 0, 0}, {0, 0, -h}, b_.look(walls[(first + wall) % 5]));
    }
    const SE3 floor(Eigen::Quaterniond::Identity(), room_.low);
    const double w = size_.x(), d = size_.y();
    surface(floor, {0, d, 0}, {w, 0, 0}, {0, -d, 0},
            b_.look(b_.rng.uniform(0, 2) ? Material::kPlanks : Material::kTiles));
    surface(floor, {0, 0, size_.z()}, {w, 0, 0}, {0, d, 0}, b_.look(Material::kCeiling));
  }

  const RoomShape& shape_;
  Box room_;       // the room that is being furnished
  Vector3d size_;  // size of room_
  MeshBuilder b_;
  double surface_px_per_m_;
  std::vector<Bounds> taken_;
};

}  // namespace

Mesh build_room(const RoomShape& shape, uint64_t seed, double focal_px) {
  return Furnisher(shape, seed, focal_px).build();
}

}  // namespace rumi::synth
