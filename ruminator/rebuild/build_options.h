// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "base/command_line/options.h"
#include "bus/wire/image_options.h"
#include "bus/wire/working_image.h"
#include "ruminator/matching/sift_features.h"
#include "ruminator/matching/window_matches.h"
#include "ruminator/model/global_model.h"
#include "ruminator/model/model_refinement.h"
#include "ruminator/model/scale_check.h"
#include "ruminator/model/torn_model.h"

namespace rumi::ruminator {

class ColmapProgram;

// How a window is rebuilt.
struct BuildOptions {
  std::string colmap = "colmap";              // the program: a name found in PATH or a path
  int nice = 19;                              // niceness of COLMAP's processes and of our building thread
  double mapper_cpu_limit_s = 120;            // most CPU time of one mapper run, s
  int max_image_side = kDefaultMaxImageSide;  // pixels; larger images are reduced to it, as in front_tracker
  Pyramid pyramid;                            // pyramid for the back submap's keypoints, as in front_tracker
  int sift_keypoints = kSiftKeypoints;        // most keypoints of an image, the strongest ones
  PairSelection pairs;
  ModelRefinementOptions refinement;
  int global_track_images = kMinTrackImages;  // only tests change it; not an option
  // The state of `colmap`, shared by all windows; null: each window asks it again. Not an option.
  std::shared_ptr<ColmapProgram> colmap_program = nullptr;
  double scale_max_change = kMaxScaleChange;
  double tear_max_severed = kMaxSevered;
  double min_parallax_px = 2;  // largest parallax of an image pair must reach it; otherwise the camera has only turned
  double max_rmse_px = 1.5;    // largest RMS reprojection error of a credible model
  double max_pair_rotation_deg = 3;       // largest median difference to the relative rotations of image pairs
  double max_rival_position_ratio = 0.1;  // largest FrontAgreement::position_ratio of a rival of the global model
};

inline void describe(OptionTable& table, BuildOptions& o) {
  describe_image(table, &o.max_image_side, &o.pyramid);
  table.group("colmap");
  table.add("ruminator.colmap", &o.colmap, "COLMAP's program: a name found in PATH, or a path");
  table.add("ruminator.nice", &o.nice, "", "niceness of rebuilding, COLMAP's processes included", 0, 19);
  table.add("ruminator.mapper_cpu_limit_s", &o.mapper_cpu_limit_s, "s",
            "CPU time of one run of COLMAP's mapper; on the wall clock 30 times that", 1, 86400);
  table.group("matching");
  table.add("ruminator.sift_keypoints", &o.sift_keypoints, "", "per image, the strongest", 100, 20000);
  table.add("ruminator.match_near", &o.pairs.near, "images",
            "apart: matched in full; farther pairs if a preview finds something", 1, 100000);
  table.add("ruminator.match_far", &o.pairs.far, "images", "of the farther pairs, the best of each image", 0, 100000);
  table.group("model");
  table.add("ruminator.resection_min_inliers", &o.refinement.resection_min_inliers, "",
            "points seen by an image, for it to have a pose", 6, 1000);
  table.add("ruminator.max_error_px", &o.refinement.max_error_px, "px", "of an observation of the model", 0.5, 20);
  table.add("ruminator.min_parallax_deg", &o.refinement.min_parallax_deg, "degrees", "of a point of the model", 0.1,
            20);
  table.add("ruminator.scale_max_change", &o.scale_max_change, "",
            "of the scale along a model, relative; more is a slip and is repaired", 0.01, 10);
  table.add("ruminator.tear_max_severed", &o.tear_max_severed, "",
            "part of two images' matches that a model may contradict", 0.01, 1);
  table.group("build");
  table.add("ruminator.min_parallax_px", &o.min_parallax_px, "px",
            "median motion beyond a turn of the camera, of some pair of images; else there is nothing to rebuild", 0,
            100);
  table.add("ruminator.max_rmse_px", &o.max_rmse_px, "px", "reprojection error of the model: beyond it it is false",
            0.1, 20);
  table.add("ruminator.max_pair_rotation_deg", &o.max_pair_rotation_deg, "degrees",
            "median difference to the rotations between pairs of images: beyond it the model is false", 0.1, 180);
  table.add("ruminator.max_rival_position_ratio", &o.max_rival_position_ratio, "",
            "difference of a model that COLMAP's mapper began alone to a credible global one, over the spread of the "
            "positions: beyond it it is false",
            0.001, 10);
}

}  // namespace rumi::ruminator
