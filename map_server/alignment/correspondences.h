// SPDX-License-Identifier: BSD-3-Clause
// Correspondences of two submaps that were made of some of the same images: frames of the same time, and landmarks that
// the same keypoint observes (the paper's M_com, section IV.C). Keypoints are matched by their distance in the image,
// not by descriptor, and the geometry is not checked: on challenging frames it is the geometry that is wrong.
#pragma once

#include <cstdint>
#include <vector>

#include "slam/map/submap.h"

namespace rumi::map_server {

// Two keyframes of the same image, one of each submap.
struct SharedKeyframe {
  int64_t utime_us = 0;
  int a = kNone, b = kNone;  // keyframe ids in the two submaps
};

// Two landmarks that are observed at the same pixel of a shared keyframe.
struct LandmarkMatch {
  int a = kNone, b = kNone;  // landmark ids
  int shared = 0;            // index into Correspondences::keyframes
  int keypoint_a = 0, keypoint_b = 0;
};

struct Correspondences {
  std::vector<int64_t> frames;            // utime_us, with a pose in both submaps; ascending
  std::vector<SharedKeyframe> keyframes;  // in ascending order of utime
  std::vector<LandmarkMatch> landmarks;   // ordered by shared keyframe; each keypoint at most once per keyframe
};

// True if the two hold the same corners of the same image, with the same indices. The positions may differ slightly,
// because front_tracker may have refined some of them since.
bool same_corners(const Features& a, const Features& b);

// Returns the keyframes of the same times, ascending. The two submaps must be of one stream.
std::vector<SharedKeyframe> shared_keyframes(const Submap& a, const Submap& b);

// Undistorted keypoints within `max_distance_px` count as the same keypoint if the two keyframes of an image do not
// have the same corners.
constexpr double kSameKeypointPx = 1.0;
Correspondences find_correspondences(const Submap& a, const Submap& b, double max_distance_px = kSameKeypointPx);

// The median logarithm of (depth in b / depth in a) over the common landmarks of one shared keyframe, and its standard
// error, estimated from the spread. The error is infinite if there are fewer than `min_landmarks` common landmarks.
struct ScaleRatio {
  double log_b_over_a = 0, sigma = 0;
  double depth_b = 0;  // median depth in b, in b's unit
};
ScaleRatio scale_ratio(const Submap& a, const Submap& b, const Correspondences& common, int shared, int min_landmarks);

}  // namespace rumi::map_server
