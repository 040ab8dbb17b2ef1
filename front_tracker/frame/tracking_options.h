// SPDX-License-Identifier: BSD-3-Clause
// The options of tracking and relocalization.
#pragma once

namespace rumi::front_tracker {

struct TrackingOptions {
  double search_radius_px = 15;  // around a landmark's predicted pixel, at octave 0, for images 640 pixels wide
  double local_radius_px = 4;    // the same for the local map, once the pose is nearly known
  int max_distance = 64;         // Hamming distance of a match
  double max_ratio = 0.9;        // best over second-best distance at the same octave
  // The largest PoseCertainty::image_px of a pose that needs no support by epipolar matches.
  double uncertain_px = 1.0;
  double lost_px() const { return 3 * uncertain_px; }  // a pose with a larger one is refused
  double max_scale_drift = 0.1;                        // standard deviation of log scale gained in a second; more: lost
  int min_first_inliers = 15;                          // matches with the last frame; fewer: brute force and resection
  int patch_inliers = 200;  // with fewer, in fast motion or blur, other landmarks are looked for by patches; 0: never
  double patch_motion = 0.02;  // fast motion: median motion since the last frame, as a share of the image's width
  // Images that come sooner after the last one with corners, and move little (KeyframeOptions::max_motion in all), are
  // tracked by patches alone; 0: none. See docs/tracking.md, "Without corners".
  double corner_interval_s = 0.14;
  int local_keyframes = 25;      // their landmarks are looked for
  double recently_lost_s = 1.0;  // so long only relocalization is tried; then a new submap may begin
  int relocalization_min_inliers = 40;
  double relocalization_min_ratio =
      0.3;  // share of the landmarks that should be in view; a third of it if the pose is certain
  int relocalization_candidates = 5;  // keyframes that are compared in full for one frame
  int back_keyframes = 200;           // of back submaps; more, and the oldest submaps are dropped; 0: none
};

}  // namespace rumi::front_tracker
