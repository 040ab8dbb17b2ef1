// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/options.h"

namespace rumi::map_server {

void describe(OptionTable& table, MergeOptions& o) {
  AlignmentOptions& a = o.builder.alignment;
  AssociationOptions& s = o.builder.association;
  PlaceSearchOptions& p = o.builder.places;
  table.group("merging");
  table.add("map_server.merge", &o.enabled,
            "join submaps into one map; no: the map is the largest submap, a front one if there is any");
  table.add("map_server.merge_interval_s", &o.interval_s, "s", "from one look at what is new to the next", 0, 1000);
  table.add("map_server.adjustment_interval_s", &o.adjustment_interval_s, "s",
            "from one adjustment of the whole map to the next, at least", 0, 1e6);
  table.add("map_server.adjustment_s_per_view", &o.adjustment_s_per_view, "s", "the same, for each image of the map", 0,
            100);
  table.add("map_server.merge_nice", &o.nice, "", "of the thread that merges", 0, 19);
  table.add("map_server.max_joint_chi2", &o.builder.max_joint_chi2, "",
            "of a joint in the map as a whole, in sigma^2; one that is farther out is a mistake, and taken out", 1,
            1e9);
  table.group("alignment");
  table.add(
      "map_server.same_keypoint_px", &a.max_pixel_distance_px, "px",
      "between keypoints of one image that are taken for one (M_com), where two submaps have not the same keypoints",
      0.01, 20);
  table.add("map_server.min_shared_keyframes", &a.min_shared_keyframes, "keyframes",
            "of two submaps, of the same images, for them to be joined", 2, 1000);
  table.add("map_server.min_landmarks", &a.min_landmarks, "landmarks", "in common, that agree", 3, 100000);
  table.add("map_server.max_reprojection_px", &a.max_reprojection_px, "px",
            "of a landmark that agrees, into the other submap, both ways", 0.1, 100);
  table.add("map_server.min_inlier_ratio", &a.min_inlier_ratio, "", "of the landmarks in common, that agree", 0, 1);
  table.add("map_server.min_keyframe_ratio", &a.min_frame_ratio, "", "of the shared keyframes, that agree", 0, 1);
  table.add("map_server.max_rotation_deg", &a.max_rotation_deg, "deg", "of a keyframe that agrees", 0, 180);
  table.add("map_server.max_center_depth_ratio", &a.max_center_depth_ratio, "",
            "of a keyframe that agrees: distance of its two places over the median depth", 0, 10);
  table.add("map_server.max_sigma_rotation_deg", &a.max_sigma_rotation_deg, "deg", "standard deviation of a joint", 0,
            180);
  table.add("map_server.max_sigma_log_scale", &a.max_sigma_log_scale, "", "standard deviation of a joint", 0, 10);
  table.group("model");
  table.add("map_server.association_rounds", &o.builder.association_rounds, "",
            "search for the map's points in all its images, and adjustment, so often", 0, 100);
  table.add("map_server.association_radius_px", &s.radius_px, "px",
            "around the projection in the first round; halved each time", 0.5, 200);
  table.add("map_server.weld_keyframes", &o.builder.weld_keyframes, "keyframes",
            "of the submaps around what is new that are bent and welded with it, about; the others stay", 1, 1000000);
  table.add("map_server.adjustment_views", &o.builder.bundle.most_views, "images",
            "of the map, adjusted at once; a larger map is adjusted in pieces", 10, 1000000);
  PostCullingOptions& c = o.builder.culling;
  table.add("map_server.cull_back_keyframes", &c.enabled,
            "take out of back submaps what the map can do without (post-culling); every frame keeps its pose");
  table.add("map_server.cull_redundant_share", &c.redundant_share, "",
            "of the points of an image, that three others see as finely, for it to be taken out", 0, 1);
  table.add("map_server.cull_kept_joints", &c.kept_joints, "keyframes",
            "kept of those that a back submap has in common with another submap", 2, 1000);
  table.group("places");
  table.add("map_server.place_candidates", &p.candidates, "", "keyframes that look alike, compared with each new one",
            0, 100);
  table.add("map_server.place_min_apart_s", &p.min_apart_s, "s", "between two keyframes of a loop", 0, 1e6);
  table.for_users({"map_server.merge"});
}

}  // namespace rumi::map_server
