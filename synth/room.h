// SPDX-License-Identifier: BSD-3-Clause
// A furnished room around a camera path, two with a doorway between them, or a scene that repeats.
#pragma once

#include <Eigen/Core>
#include <array>
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

// A scene that repeats: one cell is built, and stands in the building as many times as there are copies.
struct Repeats {
  Box cell;                                    // in the frame of the first copy
  std::array<bool, 4> walls{};                 // which walls it has: at the low y, high x, high y and low x of the cell
  std::vector<SE3> copies{};                   // map_from_cell
  std::array<std::vector<double>, 4> doors{};  // by wall: where closed doors are, m along the wall from its middle
};

struct RoomShape {
  SE3 room_from_map;                  // the room's frame: z up, walls along x and y
  Eigen::Vector3d low, high;          // corners of the whole building in the room's frame, m
  std::vector<Eigen::Vector3d> path;  // camera positions in the room's frame
  std::optional<Doorway> doorway;     // in the room's frame
  std::optional<Repeats> repeats;     // if there are some, `low` and `high` are the cell's, and `path` is seen from it

  // Returns what is furnished: one room, those on both sides of the doorway's wall, or the cell that repeats.
  std::vector<Box> rooms() const;
};

// Returns a room that the path fits into, upright along CameraPath::up(), with walls along the path's main directions.
// If there is a doorway (in the map), the building has two rooms, whose walls are along the map's axes.
RoomShape fit_room(const CameraPath& path, uint64_t seed, const std::optional<Doorway>& doorway = std::nullopt);

inline constexpr double kClearance_m = 0.5;  // nothing stands nearer to the camera's path than this

// Returns the cell of a scene that repeats, with the path as seen from each copy, so that the path is free in all.
RoomShape fit_cell(const CameraPath& path, const Repeats& repeats, const std::optional<Doorway>& doorway);

// Builds walls, floor, ceiling and furniture, painted about as finely as a camera of that focal length can see.
Mesh build_room(const RoomShape& shape, uint64_t seed, double focal_px);

// Sets the light of every vertex: light of lamps, glow, shadows and ambient occlusion.
void bake_light(Mesh& mesh, const RoomShape& shape);

}  // namespace rumi::synth
