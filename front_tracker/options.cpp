// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/options.h"

#include "base/command_line/options.h"
#include "bus/wire/image_options.h"

namespace rumi::front_tracker {
namespace {

// The prefix of the names of this process's options.
const std::string kPrefix = "front_tracker.";

void describe_tracking(OptionTable& t, TrackingOptions& r) {
  t.group("tracking");
  t.add(kPrefix + "search_radius", &r.search_radius_px, "px",
        "around a landmark's predicted place, for images 640 px wide (Th_p)", 2.0, 200.0);
  t.add(kPrefix + "uncertain_px", &r.uncertain_px, "px",
        "of the image by what is known of a pose from landmarks: beyond it other matches support it, beyond three "
        "times as much it is lost",
        0.1, 100.0);
  t.add(kPrefix + "max_scale_drift", &r.max_scale_drift, "",
        "of the scale in a second, relative (standard deviation), that tracking goes on with; beyond it: lost", 0.01,
        10.0);
  t.add(
      kPrefix + "patch_inliers", &r.patch_inliers, "",
      "landmarks that do in fast motion and in images with few corners; with fewer, others in view that no keypoint is "
      "matched to are looked for by the patches around them (keyframe_images); 0: never",
      0, 10000);
  t.add(kPrefix + "local_keyframes", &r.local_keyframes, "", "whose landmarks are looked for in a frame", 1, 200);
  t.add(kPrefix + "recently_lost_s", &r.recently_lost_s, "s", "relocalization only, before a new submap is begun", 0.0,
        60.0);
}

void describe_keyframes(OptionTable& t, KeyframeOptions& k) {
  t.add(kPrefix + "keyframe_ratio", &k.min_tracked_ratio, "",
        "a keyframe is due below this share of the reference's landmarks", 0.1, 1.0);
  t.add(
      kPrefix + "keyframe_max_motion", &k.max_motion, "",
      "median motion of the image since the last frame, of its width, from which a keyframe is due: the next frame may "
      "be too late",
      0.0, 10.0);
  t.add(kPrefix + "keyframe_min_interval_s", &k.min_interval_s, "s", "between keyframes", 0.0, 10.0);
  t.add(kPrefix + "keyframe_max_interval_s", &k.max_interval_s, "s", "a keyframe is due after so long", 0.01, 1000.0);
}

void describe_relocalization(OptionTable& t, TrackingOptions& r) {
  t.group("relocalization");
  t.add(kPrefix + "reloc_min_inliers", &r.relocalization_min_inliers, "",
        "landmarks that must agree with a relocalization", 10, 1000);
  t.add(kPrefix + "reloc_min_ratio", &r.relocalization_min_ratio, "", "of the landmarks that should be in view", 0.0,
        1.0);
  t.add(
      kPrefix + "back_keyframes", &r.back_keyframes, "keyframes",
      "of back submaps, kept to relocalize in (about 140 kB each); the oldest submaps go first; 0: front submaps only",
      0, 100000);
}

void describe_mapping(OptionTable& t, MappingOptions& m) {
  t.group("mapping");
  t.add(kPrefix + "max_log_baseline", &m.max_log_baseline, "",
        "of the distance between two keyframes that landmarks are made with, relative (standard deviation)", 0.001,
        100.0);
  t.add(kPrefix + "max_log_distance", &m.max_log_distance, "",
        "of a new landmark's distance by its keypoints' noise, relative (standard deviation)", 0.01, 10.0);
  t.add(kPrefix + "bundle_keyframes", &m.bundle_keyframes, "keyframes", "free in local bundle adjustment", 2, 200);
  t.add(kPrefix + "submap_keyframes", &m.submap_keyframes, "keyframes",
        "of a submap; with more, tracking goes on in a new one that begins with the keyframes around; 0: never", 0,
        100000);
  t.add(kPrefix + "bundle_iterations", &m.bundle_iterations, "", "of local bundle adjustment", 1, 100);
  t.add(kPrefix + "keyframe_images", &m.keyframe_images, "keyframes",
        "the latest, whose images are kept to align keypoints with (1 MB each at 640x480, a quarter more CPU); "
        "0: no aligning",
        0, 1000);
}

}  // namespace

void describe(OptionTable& t, FrontTrackerOptions& o) {
  describe_image(t, &o.max_image_side, &o.orb.pyramid);

  t.group("frame");
  t.add(kPrefix + "keypoints", &o.orb.keypoints, "", "ORB keypoints per image", 100, 20000);

  t.group("initialization");
  t.add(kPrefix + "init_min_matches", &o.initializer.min_matches, "", "between the two images that begin a submap", 20,
        10000);

  describe_tracking(t, o.tracking);
  describe_keyframes(t, o.keyframes);
  describe_relocalization(t, o.tracking);
  describe_mapping(t, o.mapping);

  t.group("front_tracker");
  t.add(kPrefix + "publish_interval_s", &o.publish_interval_s, "s", "between two updates of a submap, at least", 0.0,
        60.0);
  t.for_users({"front_tracker.keypoints"});
}

}  // namespace rumi::front_tracker
