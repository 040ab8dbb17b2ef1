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

// What was known of a keyframe's place when it was made (frame/certainty.h).
struct KeyframeCertainty {
  Eigen::Matrix3d position_covariance;  // in the submap
  double log_scale_variance = 0;
  double rotation_variance = 0;  // about one axis
};

// A submap under construction: the submap itself and what only its maker needs.
struct FrontSubmap {
  FrontSubmap() = default;
  // One that goes on from what another submap knows, as front submap `key`. Everything is new in it.
  FrontSubmap(Submap known, SubmapKey key);

  Submap map;
  std::vector<double> octave_scales;           // of the map's pyramid
  std::map<int, KeyframeCertainty> certainty;  // of the keyframes
  std::map<int, KeypointGrid> grids;           // of the keyframes, over undistorted pixels
  // Of the latest keyframes, while they may still be aligned with each other.
  std::map<int, std::shared_ptr<const ImagePyramid>> images;
  std::vector<std::pair<int, int>> recent_landmarks;  // id, keyframe that made it: still on probation

  // A keyframe at the frame's pose, observing what the frame is matched to; the frame hangs on it afterwards.
  Keyframe& add_keyframe(Frame* frame);
  // The pose of a frame that hangs on a keyframe, with its certainty.
  void add_frame(const Frame& frame);
  Landmark& add_landmark(const Eigen::Vector3d& position);
  void remove_keyframe(int id, int heir);
  // Takes out the frames from `utime_us` on, with what only their keyframes saw. At least one keyframe must be older.
  void cut_end(int64_t utime_us);
  // Removes the landmarks that most of their keyframes saw where the mask leaves something out. Returns their number.
  size_t forget_left_out(const ImageMask& mask);
  // Some of the keyframe's keypoints are elsewhere than they were.
  void keypoints_moved(int keyframe_id);
  // Keeps the newest `n` images; what became of the keypoints of the others is final.
  void keep_images(size_t n);

 private:
  std::set<int> moved_;  // keyframes with keypoints that were moved since they were made
  int next_keyframe_ = 0;
  int next_landmark_ = 0;
};

}  // namespace rumi::front_tracker
