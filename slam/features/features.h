// SPDX-License-Identifier: BSD-3-Clause
// What an image shows, as keypoints.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slam/features/descriptor.h"
#include "slam/geometry/camera.h"

namespace rumi {

inline constexpr int kNone = -1;  // no keyframe, landmark or keypoint

struct Keypoint {
  Eigen::Vector2f pixel;  // as detected, lens distortion included
  float angle_rad = 0;    // of the intensity centroid, x towards y
  uint8_t octave = 0;     // pyramid level, 0 = full resolution
};

// What a frame saw. The first three have the same length. Nothing but the place of a keypoint ever changes, and that
// only while whoever found it is at work on it (front_tracker/patches/align_keypoints.h).
struct Features {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  // The keypoints' pixels without lens distortion (Camera::undistort): derived, never on the wire.
  std::vector<Eigen::Vector2f> undistorted;
  // In which directions their places are known (slam/features/keypoint_whitening.h); known to the extractor only, empty
  // elsewhere.
  std::vector<Eigen::Matrix2f> whitenings;

  size_t size() const { return keypoints.size(); }
  // The identity where nothing is known.
  Eigen::Matrix2d whitening(size_t keypoint) const;
  void undistort(const Camera& camera);
  void move(size_t keypoint, const Eigen::Vector2f& pixel, const Camera& camera);
};

}  // namespace rumi
