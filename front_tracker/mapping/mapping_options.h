// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi::front_tracker {

struct MappingOptions {
  int neighbours = 10;  // keyframes to triangulate with and to fuse landmarks into
  // The largest standard deviations of log distances: between two keyframes that make landmarks together, and of a new
  // landmark, given the noise of its keypoints.
  double max_log_baseline = 0.1;
  double max_log_distance = 0.5;
  int max_distance = 50;            // Hamming distance of the keypoints of a new landmark, at most
  int bundle_keyframes = 24;        // free keyframes in the local bundle adjustment
  int bundle_fixed_keyframes = 24;  // fixed keyframes, which hold the free ones in place, at most
  int bundle_iterations = 5;
  int bundle_wide_every = 16;      // keyframes from one wide adjustment to the next; 0: never
  int bundle_wide_keyframes = 96;  // free keyframes in a wide adjustment; at most as many are fixed
  int keyframe_images = 15;        // latest keyframes whose images are kept for aligning keypoints; 0: no aligning
  int submap_keyframes = 300;      // with more, tracking goes on in a new submap; 0: never
  double redundant_ratio = 0.9;  // a keyframe is dropped if three others observe more than this share of its landmarks
};

}  // namespace rumi::front_tracker
