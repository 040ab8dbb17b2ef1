// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/options.h"

namespace rumi::map_server {

void describe(OptionTable& table, MergeOptions& o) {
  AlignmentOptions& a = o.builder.links.pairs.alignment;
  PlaceSearchOptions& p = o.builder.links.places;
  table.group("merging");
  table.add("map_server.merge", &o.enabled,
            "join submaps into one map; false: the map is the largest submap, a front one if there is any");
  table.add("map_server.merge_interval_s", &o.interval_s, "s", "from one look at what is new to the next", 0, 1000);
  table.add("map_server.adjustment_interval_s", &o.adjustment_interval_s, "s",
            "from one adjustment of the whole map to the next, at least; and 0.25 s for each image of it", 0, 1e6);
  table.add(
      "map_server.final_s", &o.final_s, "s",
      "adjusting the map at the end of a live run, and before a snapshot, at most; what it has by then is the map", 0,
      1e6);
  table.add("map_server.merge_nice", &o.nice, "", "of the thread that merges", 0, 19);
  table.add("map_server.max_joint_chi2", &o.builder.arrangement.graph.max_joint_chi2, "",
            "of a joint in the map as a whole, in sigma^2; one that is farther out is a mistake, and taken out", 1,
            1e9);
  table.group("alignment");
  table.add("map_server.min_landmarks", &a.min_landmarks, "landmarks", "in common, that agree", 3, 100000);
  table.add("map_server.max_reprojection_px", &a.max_reprojection_px, "px",
            "of a landmark that agrees, into the other submap, both ways", 0.1, 100);
  table.add("map_server.min_inlier_ratio", &a.min_inlier_ratio, "", "of the landmarks in common, that agree", 0, 1);
  table.add("map_server.max_sigma_log_scale", &a.max_sigma_log_scale, "",
            "standard deviation of the scale between two submaps", 0, 10);
  table.group("model");
  table.add("map_server.association_rounds", &o.builder.association_rounds, "",
            "search for the map's points in all its images, and adjustment, so often", 0, 100);
  table.add("map_server.weld_keyframes", &o.builder.arrangement.weld_keyframes, "keyframes",
            "of the submaps around what is new that are bent and welded with it, about; the others stay", 1, 1000000);
  table.add("map_server.adjustment_views", &o.builder.bundle.most_views, "images",
            "of the map, adjusted at once; a larger map is adjusted in pieces", 10, 1000000);
  table.add("map_server.cull_back_keyframes", &o.builder.culling.enabled,
            "take out of back submaps what the map can do without (post-culling); every frame keeps its pose");
  table.group("places");
  table.add("map_server.place_candidates", &p.candidates, "", "keyframes that look alike, compared with each new one",
            0, 100);
  table.add("map_server.place_min_apart_s", &p.min_apart_s, "s", "between two keyframes of a loop", 0, 1e6);
  table.for_users({"map_server.merge"});
}

}  // namespace rumi::map_server
