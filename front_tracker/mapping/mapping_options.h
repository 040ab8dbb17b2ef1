// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi::front_tracker {

struct MappingOptions {
  int neighbours = 10;  // keyframes to triangulate with and to fuse into
  // Standard deviations of logarithms: of the distance between two keyframes that landmarks are made with, and of a new
  // landmark's distance by the noise of its keypoints.
  double max_log_baseline = 0.1;
  double max_log_distance = 0.5;
  int max_distance = 50;            // Hamming distance of a new pair
  int bundle_keyframes = 24;        // free in the local bundle adjustment
  int bundle_fixed_keyframes = 24;  // that hold it in place, at most
  int bundle_iterations = 5;
  int bundle_wide_every = 16;      // keyframes from one wide adjustment to the next; 0: never
  int bundle_wide_keyframes = 96;  // free in a wide one, and as many that hold it in place
  int keyframe_images = 15;        // latest keyframes whose images are kept, to align keypoints with; 0: no aligning
  double redundant_ratio = 0.9;    // of a keyframe's landmarks seen by three others: it is dropped
};

}  // namespace rumi::front_tracker
