// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi::front_tracker {

struct MappingOptions {
  int neighbours = 10;  // keyframes to triangulate with and to fuse into
  // The largest standard deviation of the log distance between two keyframes that landmarks are made with, and of a new
  // landmark's log distance given the noise of its keypoints.
  double max_log_baseline = 0.1;
  double max_log_distance = 0.5;
  int max_distance = 50;            // Hamming distance of a new pair
  int bundle_keyframes = 24;        // free in the local bundle adjustment
  int bundle_fixed_keyframes = 24;  // fixed ones, which hold it in place, at most
  int bundle_iterations = 5;
  int bundle_wide_every = 16;      // keyframes from one wide adjustment to the next; 0: never
  int bundle_wide_keyframes = 96;  // free in a wide one; at most as many are fixed
  int keyframe_images = 15;        // latest keyframes whose images are kept, to align keypoints with; 0: no aligning
  double redundant_ratio = 0.9;  // a keyframe is dropped if three others observe more than this share of its landmarks
};

}  // namespace rumi::front_tracker
