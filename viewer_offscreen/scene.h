// SPDX-License-Identifier: BSD-3-Clause
// What a picture of a map shows, as plain data. Lengths are the map's arbitrary unit.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "slam/geometry/transform.h"
#include "slam/map/submap.h"

namespace rumi {

struct TrajectoryPoint {
  int64_t utime_us = 0;
  Eigen::Vector3d position;
  bool after_loss = false;  // frames between the point before and this one have no pose
};

struct SubmapView {
  int id = 0;
  bool placed = false;  // in the map's frame; else in its own gauge, shown apart
  int64_t frames = 0, keyframes = 0, landmark_count = 0;
  std::vector<TrajectoryPoint> trajectory;  // by time
  std::vector<Eigen::Vector3d> landmarks;
  std::vector<SE3> keyframe_poses;  // map_from_cam
};

// Consecutive frames that have a pose in no submap.
struct LostSpan {
  int64_t first_us = 0, last_us = 0;
  int64_t frames = 0;
};

struct Scene {
  std::string title = "Rumi";
  std::vector<SubmapView> submaps;
  std::vector<LostSpan> lost;
  std::vector<Eigen::Vector3d> truth;  // true path, aligned; may be empty
  std::optional<SE3> camera;           // map_from_cam of the frustum to show
  double camera_aspect = 4.0 / 3;      // width / height
  double camera_half_width = 0.61;     // of the image at distance 1
  int64_t first_us = 0;                // times in the legend count from here
  int64_t frames = 0;                  // all, with a pose or without; 0: unknown
  int64_t frames_in_map = 0;
};

// What draw_map() makes a scene of.
struct MapPicture {
  struct Item {
    const Submap* submap = nullptr;  // as it lies in the map, if it is part of it; else in its own gauge
    bool in_map = false;
  };
  std::string title = "Rumi";
  std::vector<Item> submaps = {};
  std::vector<int64_t> frame_utimes_us = {};  // of all frames, ascending, to know the lost ones; may be empty
  std::map<int64_t, Eigen::Vector3d> groundtruth =
      {};                                    // camera positions by utime_us, in the truth's own gauge; may be empty
  std::optional<SE3> camera = std::nullopt;  // map_from_cam; nothing: the last pose in the map
};

// Numbers that are not finite are left out. If no submap is placed, the one with most frames stands for the map.
Scene make_scene(const MapPicture& picture);

}  // namespace rumi
