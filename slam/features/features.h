// SPDX-License-Identifier: BSD-3-Clause
// The keypoints of an image.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "slam/features/descriptor.h"
#include "slam/geometry/camera.h"

namespace rumi {

inline constexpr int kNone = -1;  // no keyframe, landmark or keypoint

struct Keypoint {
  Eigen::Vector2f pixel;  // as detected, lens distortion included
  float angle_rad = 0;    // direction to the intensity centroid, x towards y
  uint8_t octave = 0;     // pyramid level, 0 = full resolution
};

// The keypoints of a frame. The first three vectors have the same length. Once made, only the pixel of a keypoint may
// change, and only while its maker aligns it (front_tracker/patches/align_keypoints.h).
struct Features {
  Features() = default;
  // The vectors take their memory from there; those of a later copy do not.
  explicit Features(std::pmr::memory_resource* memory)
      : keypoints(memory), descriptors(memory), undistorted(memory), whitenings(memory) {}
  Features(const Features& other, std::pmr::memory_resource* memory) : Features(memory) { *this = other; }

  std::pmr::vector<Keypoint> keypoints;
  std::pmr::vector<Descriptor> descriptors;
  // The keypoints' pixels without lens distortion (Camera::undistort); derived from `keypoints`, never transmitted.
  std::pmr::vector<Eigen::Vector2f> undistorted;
  // How precisely a pixel is known in each direction (slam/features/keypoint_whitening.h). Filled where the image is at
  // hand (by OrbExtractor and add_keypoint()), otherwise empty.
  std::pmr::vector<Eigen::Matrix2f> whitenings;

  size_t size() const { return keypoints.size(); }
  // Returns the identity if `whitenings` is empty.
  Eigen::Matrix2d whitening(size_t keypoint) const;
  void undistort(const Camera& camera);
  void move(size_t keypoint, const Eigen::Vector2f& pixel, const Camera& camera);
};

}  // namespace rumi
