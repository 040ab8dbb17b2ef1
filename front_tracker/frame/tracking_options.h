// SPDX-License-Identifier: BSD-3-Clause
// What tracking and relocalization ask of a pose.
#pragma once

namespace rumi::front_tracker {

struct TrackingOptions {
  double search_radius_px = 15;  // around a landmark's predicted pixel, at octave 0, for images 640 pixels wide
  double local_radius_px = 4;    // the same for the local map, once the pose is nearly known
  int max_distance = 64;         // Hamming distance of a match
  double max_ratio = 0.9;        // best over second-best distance at the same octave
  // How far off the image may be by what is known of a pose (PoseCertainty::image_px), for the pose to need no support.
  double uncertain_px = 1.0;
  double lost_px() const { return 3 * uncertain_px; }  // the same, for it to be a pose at all
  double max_scale_drift = 0.1;  // of the logarithm of scale in a second, standard deviation; more: lost
  int min_first_inliers = 15;    // of the matches with the last frame; fewer: brute force and resection
  int patch_inliers = 200;     // fewer, in fast motion or blur: the other landmarks are looked for by patches; 0: never
  double patch_motion = 0.02;  // median motion of the image since the last frame, of its width, that counts as fast
  // Images sooner than that after the last one with corners are tracked by patches alone where they move little (by
  // KeyframeOptions::max_motion in all); 0: none. See docs/tracking.md, "Without corners".
  double corner_interval_s = 0.14;
  int local_keyframes = 25;      // whose landmarks are looked for
  double recently_lost_s = 1.0;  // only relocalization is tried; after it a new submap is begun
  int relocalization_min_inliers = 40;
  double relocalization_min_ratio = 0.3;  // of the landmarks that should be in view; a third if the pose is certain
  int relocalization_candidates = 5;      // keyframes that are compared in full, per frame
  int back_keyframes = 200;               // of back submaps, kept to relocalize in: the oldest submaps go; 0: none
};

}  // namespace rumi::front_tracker
