// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "front_tracker/frame/frame.h"
#include "slam/map/submap.h"

namespace rumi::front_tracker {

// How well a keyframe's pose was known when it was made (frame/certainty.h).
struct KeyframeCertainty {
  Eigen::Matrix3d position_covariance;  // in the submap
  double log_scale_variance = 0;
  double rotation_variance = 0;  // about one axis
};

// A submap under construction, with the data that only its maker needs.
struct FrontSubmap {
  FrontSubmap() = default;
  // Begins front submap `key` as a copy of another submap. Everything in it is new.
  FrontSubmap(Submap known, SubmapKey key);

  Submap map;
  std::vector<double> octave_scales;           // Pyramid::scales() of the map
  std::map<int, KeyframeCertainty> certainty;  // by keyframe
  std::map<int, KeypointGrid> grids;           // by keyframe, over undistorted pixels
  // The images of the latest keyframes, while they may still be aligned with each other.
  std::map<int, std::shared_ptr<const ImagePyramid>> images;
  std::vector<std::pair<int, int>> recent_landmarks;  // on probation: id, keyframe that made it

  // Adds a keyframe at the frame's pose that observes the frame's matches. The frame refers to it afterwards.
  Keyframe& add_keyframe(Frame* frame);
  // Adds the pose of a frame that refers to a keyframe, with its sigmas.
  void add_frame(const Frame& frame);
  Landmark& add_landmark(const Eigen::Vector3d& position);
  void remove_keyframe(int id, int heir);
  // Removes the frames from `utime_us` on, and the landmarks that only their keyframes observe. At least one keyframe
  // must be older.
  void cut_end(int64_t utime_us);
  // Removes the landmarks that most of their keyframes observe at pixels that the mask leaves out. Returns their
  // number.
  size_t forget_left_out(const ImageMask& mask);
  // Call it after some of the keyframe's keypoints were moved.
  void keypoints_moved(int keyframe_id);
  // Keeps the newest `n` images. The keypoints of the others do not move any more.
  void keep_images(size_t n);
  // The submap is complete.
  void close();

 private:
  std::set<int> moved_;  // keyframes with moved keypoints
  int next_keyframe_ = 0;
  int next_landmark_ = 0;
};

}  // namespace rumi::front_tracker
