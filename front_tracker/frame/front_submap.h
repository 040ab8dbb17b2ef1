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
  Eigen::Matrix3d position_covariance;  // covariance of the camera's centre, in the submap
  double log_scale_variance = 0;
  double rotation_variance = 0;  // variance of the rotation about one axis
};

// A submap under construction, with the data that only its maker needs.
struct FrontSubmap {
  FrontSubmap() = default;
  // Begins the front submap `key` as a copy of another submap. All its elements count as new.
  FrontSubmap(Submap known, SubmapKey key);

  Submap map;
  std::vector<double> octave_scales;           // Pyramid::scales() of map.pyramid
  std::map<int, KeyframeCertainty> certainty;  // by keyframe
  std::map<int, KeypointGrid> grids;           // by keyframe; they find keypoints by their undistorted pixels
  // The images of the latest keyframes, while they may still be aligned with each other.
  std::map<int, std::shared_ptr<const ImagePyramid>> images;
  std::vector<std::pair<int, int>> recent_landmarks;  // landmarks on probation: id, and keyframe that made it

  // Adds a keyframe at the frame's pose that observes the frame's matches. It becomes the frame's reference.
  Keyframe& add_keyframe(Frame* frame);
  // Adds the pose of a frame that refers to a keyframe, with its sigmas.
  void add_frame(const Frame& frame);
  Landmark& add_landmark(const Eigen::Vector3d& position);
  void remove_keyframe(int id, int heir);
  // Removes the frames and keyframes from `utime_us` on, and the landmarks that fewer than two of the remaining
  // keyframes observe. At least one keyframe must be older.
  void cut_end(int64_t utime_us);
  // Removes each landmark that most of its keyframes observe at pixels that the mask leaves out. Returns the number of
  // removed landmarks.
  size_t forget_left_out(const ImageMask& mask);
  // To be called after some of the keyframe's keypoints were moved.
  void keypoints_moved(int keyframe_id);
  // Keeps the newest `n` images. The keypoints of older keyframes do not move any more.
  void keep_images(size_t n);
  // Frees what only mapping needs, until wake(). No keyframe may wait for the mapper.
  void rest() { grids.clear(); }
  void wake();
  // Marks the submap as complete.
  void close();

 private:
  std::set<int> moved_;  // keyframes with moved keypoints
  int next_keyframe_ = 0;
  int next_landmark_ = 0;
};

}  // namespace rumi::front_tracker
