// SPDX-License-Identifier: BSD-3-Clause
// What two submaps have in common because they were made of the same images: frames of the same time, and landmarks
// that the same keypoint observes (the paper's M_com, section IV.C: by the distance in the image, not by descriptor,
// and without a check of the geometry, which on challenging frames is what is wrong).
#pragma once

#include <cstdint>
#include <vector>

#include "slam/map/submap.h"

namespace rumi::map_server {

// Keyframes of the same image, one of each submap.
struct SharedKeyframe {
  int64_t utime_us = 0;
  int a = kNone, b = kNone;  // ids
};

// One observation each of the same pixel in a shared keyframe.
struct LandmarkMatch {
  int a = kNone, b = kNone;  // landmark ids
  int shared = 0;            // index into Correspondences::keyframes
  int keypoint_a = 0, keypoint_b = 0;
};

struct Correspondences {
  std::vector<int64_t> frames;            // utime_us, with a pose in both submaps; ascending
  std::vector<SharedKeyframe> keyframes;  // ascending utime
  std::vector<LandmarkMatch> landmarks;   // by shared keyframe; each keypoint at most once in each
};

// Keypoint by keypoint the same corners of the same image: front_tracker may have moved some of them since, to where
// they are more exactly.
bool same_corners(const Features& a, const Features& b);

// Where keyframes of one image do not have the same corners: `max_distance_px` between keypoints (undistorted) that are
// taken for one.
constexpr double kSameKeypointPx = 1.0;
Correspondences find_correspondences(const Submap& a, const Submap& b, double max_distance_px = kSameKeypointPx);

// Logarithm of the depth of the common landmarks of a shared keyframe in b over that in a: the median, and its standard
// error from the spread. Infinite error where there are fewer than `min_landmarks`.
struct ScaleRatio {
  double log_b_over_a = 0, sigma = 0;
  double depth_b = 0;  // median
};
ScaleRatio scale_ratio(const Submap& a, const Submap& b, const Correspondences& common, int shared, int min_landmarks);

}  // namespace rumi::map_server
