// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/options.h"

#include "base/options.h"

namespace rumi::front_tracker {

void describe(OptionTable& t, FrontTrackerOptions& o) {
  const std::string s = "front_tracker.";
  t.group("frame");
  t.add(s + "keypoints", &o.orb.keypoints, "", "ORB keypoints per image", 100, 20000);
  t.add(s + "levels", &o.orb.levels, "", "levels of the image pyramid", 1, 12);
  t.add(s + "scale_factor", &o.orb.scale_factor, "", "between two levels", 1.05, 2.0);
  t.add(s + "fast_threshold", &o.orb.fast_threshold, "grey levels", "contrast of a corner", 1, 100);
  t.add(s + "cell_px", &o.orb.cell_px, "px", "keypoints are spread over cells of this size", 8, 200);

  t.group("initialization");
  InitializerOptions& i = o.initializer;
  t.add(s + "init_keypoints", &i.keypoints, "", "keypoints per image while there is no submap to track", 200, 20000);
  t.add(s + "init_min_matches", &i.min_matches, "", "between the two images that begin a submap", 20, 10000);
  t.add(s + "init_max_frames", &i.max_frames, "frames", "buffered until a submap stands; they get poses afterwards", 3,
        1000);
  t.add(s + "init_max_rmse", &i.max_rmse_px, "px", "reprojection error after the first bundle adjustment", 0.1, 10.0);
  t.add(s + "init_min_points", &i.two_view.min_points, "", "triangulated by the first pair", 10, 5000);

  t.group("tracking");
  TrackingOptions& r = o.tracking;
  t.add(s + "search_radius", &r.search_radius_px, "px",
        "around a landmark's predicted place, for images 640 px wide (Th_p)", 2.0, 200.0);
  t.add(s + "local_radius", &r.local_radius_px, "px", "the same once the pose is nearly known", 1.0, 100.0);
  t.add(s + "max_distance", &r.max_distance, "bits", "Hamming distance of a match (Th_d)", 10, 128);
  t.add(s + "max_ratio", &r.max_ratio, "", "best over second-best distance of a match", 0.3, 1.0);
  t.add(s + "uncertain_px", &r.uncertain_px, "px",
        "of the image by what is known of a pose from landmarks: beyond it other matches support it, beyond three "
        "times as much it is lost",
        0.1, 100.0);
  t.add(s + "max_scale_drift", &r.max_scale_drift, "",
        "of the scale in a second, relative (standard deviation), that tracking goes on with; beyond it: lost", 0.01,
        10.0);
  t.add(
      s + "patch_inliers", &r.patch_inliers, "",
      "landmarks that do in fast motion and in images with few corners; with fewer, others in view that no keypoint is "
      "matched to are looked for by the patches around them (keyframe_images); 0: never",
      0, 10000);
  t.add(s + "patch_motion", &r.patch_motion, "",
        "median motion of the image since the last frame, of its width, that counts as fast there", 0.0, 10.0);
  t.add(
      s + "corner_interval_s", &r.corner_interval_s, "s",
      "images sooner after the last one with corners are tracked by patches alone (keyframe_images) where they move by "
      "less than patch_motion each and keyframe_max_motion in all, for 40 % less CPU at 30 Hz; 0: corners in every "
      "image",
      0.0, 10.0);
  t.add(s + "local_keyframes", &r.local_keyframes, "", "whose landmarks are looked for in a frame", 1, 200);
  t.add(s + "recently_lost_s", &r.recently_lost_s, "s", "relocalization only, before a new submap is begun", 0.0, 60.0);
  KeyframeOptions& k = o.keyframes;
  t.add(s + "keyframe_ratio", &k.min_tracked_ratio, "",
        "a keyframe is due below this share of the reference's landmarks", 0.1, 1.0);
  t.add(s + "keyframe_urgent_ratio", &k.urgent_tracked_ratio, "",
        "a keyframe is due at once below this share, whatever the interval", 0.0, 1.0);
  t.add(
      s + "keyframe_max_motion", &k.max_motion, "",
      "median motion of the image since the last frame, of its width, from which a keyframe is due: the next frame may "
      "be too late",
      0.0, 10.0);
  t.add(s + "keyframe_min_interval_s", &k.min_interval_s, "s", "between keyframes", 0.0, 10.0);
  t.add(s + "keyframe_max_interval_s", &k.max_interval_s, "s", "a keyframe is due after so long", 0.01, 1000.0);
  t.add(s + "keyframe_min_inliers", &k.min_inliers, "", "fewer matches: a keyframe is due sooner", 0, 5000);

  t.group("relocalization");
  t.add(s + "reloc_min_inliers", &r.relocalization_min_inliers, "", "landmarks that must agree with a relocalization",
        10, 1000);
  t.add(s + "reloc_min_ratio", &r.relocalization_min_ratio, "", "of the landmarks that should be in view", 0.0, 1.0);
  t.add(s + "reloc_candidates", &r.relocalization_candidates, "", "keyframes compared in full per frame", 1, 100);
  t.add(
      s + "back_keyframes", &r.back_keyframes, "keyframes",
      "of back submaps, kept to relocalize in (about 140 kB each); the oldest submaps go first; 0: front submaps only",
      0, 100000);

  t.group("mapping");
  MappingOptions& m = o.mapping;
  t.add(s + "neighbours", &m.neighbours, "keyframes", "to triangulate with and to fuse into", 1, 100);
  t.add(s + "max_log_baseline", &m.max_log_baseline, "",
        "of the distance between two keyframes that landmarks are made with, relative (standard deviation)", 0.001,
        100.0);
  t.add(s + "max_log_distance", &m.max_log_distance, "",
        "of a new landmark's distance by its keypoints' noise, relative (standard deviation)", 0.01, 10.0);
  t.add(s + "bundle_keyframes", &m.bundle_keyframes, "keyframes", "free in local bundle adjustment", 2, 200);
  t.add(s + "bundle_fixed_keyframes", &m.bundle_fixed_keyframes, "keyframes", "that hold it in place, at most", 0, 200);
  t.add(s + "bundle_iterations", &m.bundle_iterations, "", "of local bundle adjustment", 1, 100);
  t.add(s + "bundle_wide_every", &m.bundle_wide_every, "keyframes",
        "from one local bundle adjustment that is wide to the next; 0: none is", 0, 10000);
  t.add(s + "bundle_wide_keyframes", &m.bundle_wide_keyframes, "keyframes",
        "free in a wide one, and at most as many that hold it in place", 2, 1000);
  t.add(s + "keyframe_images", &m.keyframe_images, "keyframes",
        "the latest, whose images are kept to align keypoints with (1 MB each at 640x480, a quarter more CPU); "
        "0: no aligning",
        0, 1000);
  t.add(s + "redundant_ratio", &m.redundant_ratio, "", "of a keyframe's landmarks seen by three others: it is dropped",
        0.5, 1.0);

  t.group("front_tracker");
  t.add(s + "max_image_side", &o.max_image_side, "px",
        "larger images are worked on at this size; 0: never; ruminator's must be the same", 0, 100000);
  t.add(s + "publish_interval_s", &o.publish_interval_s, "s", "between two updates of a submap, at least", 0.0, 60.0);
  t.for_users({"front_tracker.keypoints", "front_tracker.max_image_side"});
}

}  // namespace rumi::front_tracker
