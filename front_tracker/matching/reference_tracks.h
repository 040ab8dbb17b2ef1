// SPDX-License-Identifier: BSD-3-Clause
// Follows the keypoints of one frame through the frames after it. This is cheap because each keypoint is looked for
// only near its expected place.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "front_tracker/frame/frame.h"
#include "front_tracker/matching/frame_motion.h"
#include "slam/features/matching.h"

namespace rumi::front_tracker {

class ReferenceTracks {
 public:
  explicit ReferenceTracks(std::shared_ptr<const Features> reference);

  // Looks for all keypoints in the next frame. `motion` is the motion from the frame before to this one.
  void follow(const Camera& camera, const FrameMotion& motion, const Frame& frame);

  const Features& reference() const { return *reference_; }
  // found()[f][i] is the keypoint that is keypoint i of the reference in the f-th frame that was followed, or kNone.
  const std::vector<std::vector<int>>& found() const { return found_; }
  // Returns how many keypoints were found in the newest frame.
  int count() const { return count_; }
  // Returns the median motion of these keypoints since the reference, in pixels, beyond a rotation of the camera. Only
  // this part of the motion tells about depth. It is small if the parallax is small, and on a plane that faces the
  // camera.
  double motion_px() const { return motion_px_; }

 private:
  BestMatch find(size_t keypoint, const Frame& frame, float radius_px) const;
  void measure_motion(const Camera& camera, const Features& now);
  std::shared_ptr<const Features> reference_;
  std::vector<Eigen::Vector2f> expected_;  // undistorted pixel of each keypoint in the newest frame
  std::vector<int> unseen_;                // by keypoint: frames in a row without it, which widen its search
  std::vector<std::vector<int>> found_;
  int count_ = 0;
  double motion_px_ = 0;
};

}  // namespace rumi::front_tracker
