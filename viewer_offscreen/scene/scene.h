// SPDX-License-Identifier: BSD-3-Clause
// A scene is all that a picture of a map shows, as plain values in the map's frame of reference.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slam/geometry/transform.h"
#include "slam/map/submap.h"
#include "viewer_offscreen/scene/timeline.h"

namespace rumi::viewer_offscreen {

struct TrajectoryPoint {
  int64_t utime_us = 0;
  Eigen::Vector3d position;
  bool after_loss = false;  // true if frames between the point before and this one have no pose
};

struct KeyframeView {
  int64_t utime_us = 0;
  SE3 map_from_cam;
};

struct SubmapView {
  SubmapKey key;
  SubmapKind kind = SubmapKind::kFront;
  int color = 0;        // see submap_color()
  bool placed = false;  // true: it lies in the map; false: it has a unit and axes of its own, and is shown apart
  int64_t frames = 0, keyframes = 0, landmark_count = 0;
  std::vector<TrajectoryPoint> trajectory;  // in order of time
  std::vector<Eigen::Vector3f> landmarks;
  std::vector<KeyframeView> keyframe_poses;
  std::vector<std::pair<size_t, size_t>> covisible;  // pairs of keyframe_poses that share many landmarks
};

// Two submaps that were joined: the positions, by either submap, of a place that both saw.
struct MergeView {
  Eigen::Vector3d at_a, at_b;
  bool same_images = false;
};

// An image of the camera, with the keypoints of a keyframe.
struct CameraView {
  cv::Mat image;  // BGR; empty if there is none
  int64_t utime_us = 0;
  cv::Size size;                                  // size of the image in which the keypoints were found
  std::vector<cv::Point2f> on_landmarks, others;  // in pixels of that image
  std::string caption;
};

struct Scene {
  std::string title = "Rumi";
  std::vector<SubmapView> submaps;
  std::vector<LostSpan> lost;
  Timeline timeline;
  std::vector<MergeView> merges;
  int refused_links = 0;
  std::vector<Eigen::Vector3d> truth;     // true path, aligned to the map; may be empty
  std::optional<double> metres_per_unit;  // length of the map's unit, from the true path
  std::optional<SE3> camera;              // map_from_cam of the frustum to show
  double camera_aspect = 4.0 / 3;         // width / height
  double camera_half_width = 0.61;        // half the width of the image at distance 1
  CameraView camera_view;
  int64_t first_us = 0, last_us = 0;  // times in the picture are counted from first_us
  int64_t frames = 0;                 // all frames, with or without a pose; 0: unknown
  int64_t frames_in_map = 0;
};

// The input of make_scene().
struct MapPicture {
  struct Item {
    const Submap* submap = nullptr;  // if it is part of the map, placed in it; otherwise in its own gauge
    bool in_map = false;
  };
  // A link between two submaps, accepted or not. If a == b, it is a loop.
  struct Link {
    SubmapKey a, b;
    bool same_images = false, accepted = false;
  };
  std::string title = "Rumi";
  std::vector<Item> submaps = {};
  std::vector<Link> links = {};
  std::vector<FrameNote> frames = {};                   // all frames, ascending in time; may be empty
  std::map<int64_t, Eigen::Vector3d> groundtruth = {};  // camera positions by utime_us, in metres; may be empty
  std::optional<SE3> camera = std::nullopt;             // map_from_cam; nullopt: the last pose in the map is shown
  CameraView camera_view = {};
};

// Makes the scene of a picture. Numbers that are not finite are left out. If no submap is placed, the one with the most
// frames is shown as the map.
Scene make_scene(const MapPicture& picture);

// These two do the same in two steps, for a caller that keeps the views of submaps that have not changed.
SubmapView view_submap(const Submap& submap);
Scene make_scene(const MapPicture& picture, std::vector<SubmapView> submaps);

}  // namespace rumi::viewer_offscreen
