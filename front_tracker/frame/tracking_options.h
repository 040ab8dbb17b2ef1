// SPDX-License-Identifier: BSD-3-Clause
// The options of tracking and relocalization.
#pragma once

namespace rumi::front_tracker {

struct TrackingOptions {
  double search_radius_px = 15;  // radius around a landmark's predicted pixel at octave 0, in images 640 pixels wide
  double local_radius_px = 4;    // as search_radius_px, for the local map, once the pose is nearly known
  int max_distance = 64;         // Hamming distance of a match, at most
  double max_ratio = 0.9;        // as ProjectionSearch::max_ratio
  // The largest PoseCertainty::image_px of a pose that does not need epipolar matches as a support.
  double uncertain_px = 1.0;
  double lost_px() const { return 3 * uncertain_px; }  // a pose with a larger image_px is refused
  double max_scale_drift = 0.1;                        // square root of the variance of the log scale that is gained in
                                                       // a second; with more, the camera is lost
  int min_first_inliers = 15;                          // inliers of the matches with the last frame, at least; with
                                                       // fewer, brute-force matching and resection are tried
  int patch_inliers = 200;  // with fewer, in fast motion or blur, other landmarks are looked for by patches; 0: never
  double patch_motion = 0.02;  // fast motion: median motion since the last frame, as a share of the image's width
  // Images that come sooner after the last one with corners, and move little (KeyframeOptions::max_motion in all), are
  // tracked by patches alone; 0: none. See docs/tracking.md, "Without corners".
  double corner_interval_s = 0.14;
  int local_keyframes = 25;      // keyframes whose landmarks are looked for
  double recently_lost_s = 1.0;  // time after a loss in which only relocalization is tried; then a new submap may begin
  int relocalization_min_inliers = 40;
  // The share of the landmarks in view that must be found. A third of it suffices if the pose is certain.
  double relocalization_min_ratio = 0.3;
  int relocalization_candidates = 5;  // keyframes that a frame is compared with in full
  int back_keyframes = 200;           // keyframes of back submaps that are kept; with more, the oldest submaps are
                                      // dropped; 0: none
};

}  // namespace rumi::front_tracker
