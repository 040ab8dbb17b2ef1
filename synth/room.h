// SPDX-License-Identifier: BSD-3-Clause
// A furnished room around a camera path, or two with a doorway between them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "synth/camera_path.h"
#include "synth/mesh.h"

namespace rumi::synth {

// An opening to walk through, in a wall along y that parts a building in two rooms.
struct Doorway {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  // its middle on the floor, metres
  double width_m = 1.3, height_m = 2.15;
  double wall_m = 0.12;  // the wall is so thick
};

struct Box {
  Eigen::Vector3d low, high;
};

struct RoomShape {
  SE3 room_from_map;                  // room: z up, walls along x and y
  Eigen::Vector3d low, high;          // corners of the whole building, metres, in the room
  std::vector<Eigen::Vector3d> path;  // camera positions in the room
  std::optional<Doorway> doorway;     // in the room

  std::vector<Box> rooms() const;  // one, or the two on either side of the doorway's wall
};

// A room that the path fits into, upright along CameraPath::up(), its walls along the path's main directions. If there
// is a doorway (in the map), the building has two rooms, and their walls are along the map's axes.
RoomShape fit_room(const CameraPath& path, uint64_t seed, const std::optional<Doorway>& doorway = std::nullopt);

inline constexpr double kClearance_m = 0.5;  // nothing stands nearer to the path

// Walls, floor, ceiling and furniture, painted as finely as a camera of that focal length can see.
Mesh build_room(const RoomShape& shape, uint64_t seed, double focal_px);

// Sets every vertex's light: lamps, the windows' light, shadows and ambient occlusion.
void bake_light(Mesh& mesh, const RoomShape& shape);

}  // namespace rumi::synth
