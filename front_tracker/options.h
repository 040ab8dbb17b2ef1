// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bus/working_image.h"
#include "slam/features/orb_extractor.h"
#include "slam/geometry/two_view.h"

namespace rumi {

class OptionTable;

struct InitializerOptions {
  int keypoints = 2000;   // per image while there is no submap to track
  int min_matches = 100;  // with the reference image; fewer: a later reference
  int max_frames = 120;   // buffered; they get their poses once the submap stands
  int max_keyframes = 6;  // of the first bundle adjustment
  double min_motion_px =
      4.5;  // median, beyond what a rotation explains, for images 640 px wide; less: nothing is tried
  double accept_parallax_deg = 2.5;  // median, at which the first good pair is taken at once
  double min_parallax_deg = 1.75;  // below it a pair is refused; between the two it is taken if no better one can come
  double max_rmse_px = 1.2;        // after the first bundle adjustment
  // Motion beyond a rotation over that error, for images narrower than 640 px less by the square; less: more motion is
  // waited for.
  double min_motion_to_rmse = 10;
  double max_rival_rmse_ratio = 0.9;  // of the two best structures' errors, where two views allow two (a plane does)
  TwoViewOptions two_view;
};

struct TrackingOptions {
  double search_radius_px = 15;  // around a landmark's predicted pixel, at octave 0, for images 640 pixels wide
  double local_radius_px = 4;    // the same for the local map, once the pose is nearly known
  int max_distance = 64;         // Hamming distance of a match
  double max_ratio = 0.9;        // best over second-best distance at the same octave
  int min_inliers = 25;          // fewer: lost
  int min_established = 25;      // of these, seen by three keyframes; fewer: lost, for nothing carries the scale on
  double min_established_parallax_deg = 6;  // of these, to count fully; less counts by its square times the sights
  int min_first_inliers = 15;               // of the matches with the last frame; fewer: brute force and resection
  int patch_inliers = 200;     // fewer, in fast motion or blur: the other landmarks are looked for by patches; 0: never
  double patch_motion = 0.02;  // median motion of the image since the last frame, of its width, that counts as fast
  int epipolar_inliers = 70;   // fewer: matches with earlier frames that are no landmarks help too; 0: never
  // Images sooner than that after the last one with corners are tracked by patches alone where they move little (by
  // KeyframeOptions::max_motion in all); 0: none. See docs/tracking.md, "Without corners".
  double corner_interval_s = 0.14;
  int local_keyframes = 25;  // whose landmarks are looked for
  // A pose with fewer landmarks that is farther from where the motion so far leads than these accelerations and the
  // poses' own noise explain becomes no keyframe.
  int sure_inliers = 80;
  double max_angular_acceleration = 700;  // degrees/s²
  double max_acceleration = 3.5;          // median depths of the landmarks/s²: a submap has no metres
  double recently_lost_s = 1.0;           // only relocalization is tried; after it a new submap is begun
  int relocalization_min_inliers = 40;
  double relocalization_min_ratio = 0.3;  // of the landmarks that should be in view
  int relocalization_sure_inliers = 60;   // with as many a third of that ratio does
  int relocalization_candidates = 5;      // keyframes that are compared in full, per frame
  int back_keyframes = 200;               // of back submaps, kept to relocalize in: the oldest submaps go; 0: none
};

struct KeyframeOptions {
  double min_tracked_ratio = 0.7;     // of the reference keyframe's landmarks; fewer: a keyframe is due
  double urgent_tracked_ratio = 0.6;  // the same, whatever the interval since the last keyframe
  double max_motion = 0.03;           // of the image between two frames (median, of its width); more: one is due
  double min_interval_s = 0.09;
  double max_interval_s = 1.0;
  int min_inliers = 100;  // fewer: a keyframe is due sooner
};

struct MappingOptions {
  int neighbours = 10;               // keyframes to triangulate with and to fuse into
  double min_parallax_deg = 1.0;     // of a new landmark
  double min_baseline_ratio = 0.03;  // of two keyframes, over the median depth; see docs/tracking.md, "Mapping"
  int max_distance = 50;             // Hamming distance of a new pair
  int bundle_keyframes = 24;         // free in the local bundle adjustment
  int bundle_fixed_keyframes = 24;   // that hold it in place, at most
  int bundle_iterations = 5;
  int bundle_wide_every = 16;      // keyframes from one wide adjustment to the next; 0: never
  int bundle_wide_keyframes = 96;  // free in a wide one, and as many that hold it in place
  int keyframe_images = 15;        // latest keyframes whose images are kept, to align keypoints with; 0: no aligning
  double redundant_ratio = 0.9;    // of a keyframe's landmarks seen by three others: it is dropped
};

struct FrontTrackerOptions {
  OrbOptions orb;
  InitializerOptions initializer;
  TrackingOptions tracking;
  KeyframeOptions keyframes;
  MappingOptions mapping;
  bool mapping_thread = true;                 // false: mapping is done before the next frame (replay: repeatable)
  double publish_interval_s = 0.5;            // between two updates of a submap, at least (frame time)
  int max_image_side = kDefaultMaxImageSide;  // pixels; larger images are worked on smaller
  std::string camera_file;                    // overrides the calibration that comes with the images
};

void describe(OptionTable& table, FrontTrackerOptions& options);

}  // namespace rumi
