// SPDX-License-Identifier: BSD-3-Clause
// The keypoints of one frame, found again in those that follow it: cheap, because each is looked for only where it
// should be by now.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "front_tracker/frame/frame.h"
#include "slam/features/matching.h"

namespace rumi::front_tracker {

// How the image moved between two frames, taken for a rotation of the camera.
struct FrameMotion {
  Eigen::Matrix3d b_from_a = Eigen::Matrix3d::Identity();
  double radius_px = 0;  // within which to look for what a rotation does not explain
};
FrameMotion estimate_motion(const Camera& camera, const Features& a, const Features& b);

class ReferenceTracks {
 public:
  explicit ReferenceTracks(std::shared_ptr<const Features> reference);

  // Looks for all keypoints in the next frame; `motion` is that from the frame before it.
  void follow(const Camera& camera, const FrameMotion& motion, const Frame& frame);

  const Features& reference() const { return *reference_; }
  // In the frames followed so far: per keypoint of the reference the keypoint there, or kNone.
  const std::vector<std::vector<int>>& found() const { return found_; }
  // Keypoints found in the newest frame.
  int count() const { return count_; }
  // How far these moved since the reference, beyond a rotation of the camera: median, pixels. What two views can tell
  // about depth is in this motion alone: it is small where parallax is, and on a plane that faces the camera.
  double motion_px() const { return motion_px_; }

 private:
  BestMatch find(size_t keypoint, const Frame& frame, float radius_px) const;
  void measure_motion(const Camera& camera, const Features& now);
  std::shared_ptr<const Features> reference_;
  std::vector<Eigen::Vector2f> expected_;  // undistorted pixel of each keypoint in the newest frame
  std::vector<int> unseen_;                // frames in a row without it: the farther it may be from there
  std::vector<std::vector<int>> found_;
  int count_ = 0;
  double motion_px_ = 0;
};

}  // namespace rumi::front_tracker
