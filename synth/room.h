// SPDX-License-Identifier: BSD-3-Clause
// A furnished room around a camera path, or two with a doorway between them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "synth/camera_path.h"
#include "synth/mesh.h"

namespace rumi::synth {

// A doorway, in a wall along y that divides a building into two rooms.
struct Doorway {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  // middle of the doorway on the floor, m
  double width_m = 1.3, height_m = 2.15;
  double wall_m = 0.12;  // thickness of the wall
};

struct Box {
  Eigen::Vector3d low, high;
};

struct RoomShape {
  SE3 room_from_map;                  // the room's frame: z up, walls along x and y
  Eigen::Vector3d low, high;          // corners of the whole building in the room's frame, m
  std::vector<Eigen::Vector3d> path;  // camera positions in the room's frame
  std::optional<Doorway> doorway;     // in the room's frame

  std::vector<Box> rooms() const;  // one room, or those on both sides of the doorway's wall
};

// Returns a room that the path fits into, upright along CameraPath::up(), with walls along the path's main directions.
// If there is a doorway (in the map), the building has two rooms, whose walls are along the map's axes.
RoomShape fit_room(const CameraPath& path, uint64_t seed, const std::optional<Doorway>& doorway = std::nullopt);

inline constexpr double kClearance_m = 0.5;  // nothing stands nearer to the camera's path than this

// Builds walls, floor, ceiling and furniture, painted about as finely as a camera of that focal length can see.
Mesh build_room(const RoomShape& shape, uint64_t seed, double focal_px);

// Sets the light of every vertex: light of lamps, glow, shadows and ambient occlusion.
void bake_light(Mesh& mesh, const RoomShape& shape);

}  // namespace rumi::synth
