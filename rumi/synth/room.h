// SPDX-License-Identifier: BSD-3-Clause
// A furnished room around a camera path.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rumi/synth/camera_path.h"
#include "rumi/synth/mesh.h"

namespace rumi {

struct RoomShape {
  SE3 room_from_map;                  // room: z up, walls along x and y
  Eigen::Vector3d low, high;          // the room's corners, metres, in the room
  std::vector<Eigen::Vector3d> path;  // camera positions in the room
};

// A room that the path fits into, upright by the path's own idea of up, its walls along the path's main directions.
RoomShape fit_room(const CameraPath& path, uint64_t seed);

inline constexpr double kClearance_m = 0.5;  // nothing stands nearer to the path

// Walls, floor, ceiling and furniture, painted; detail to suit a camera of that focal length.
Mesh build_room(const RoomShape& shape, uint64_t seed, double focal_px);

// Sets every vertex's light: lamps, the windows' light, shadows and ambient occlusion.
void bake_light(Mesh& mesh, const RoomShape& shape);

}  // namespace rumi
