// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bus/options.h"
#include "ruminator/back_landmarks.h"
#include "ruminator/global_model.h"
#include "ruminator/model_refinement.h"
#include "ruminator/scale_check.h"
#include "ruminator/sift_features.h"
#include "ruminator/window_matches.h"

namespace rumi {

// How a window is rebuilt.
struct BuildOptions {
  std::string colmap = "colmap";     // the program: a name found in PATH or a path
  int nice = 19;                     // of COLMAP's processes and of our own building thread
  double mapper_time_limit_s = 120;  // of one mapper run
  SiftOptions sift;
  SiftMatchOptions matching;
  PairSelection pairs;
  GlobalModelOptions global;
  ModelRefinementOptions refinement;
  ScaleCheckOptions scale;
  BackLandmarkOptions landmarks;
  int look_images = 6;                // of a long gap, looked at first
  int look_min_keypoints = 50;        // in one of them, or the gap is blind
  double min_parallax_px = 2;         // of some pair of images, or the camera has only turned
  double max_rmse_px = 1.5;           // of the reprojection
  double max_pair_rotation_deg = 3;   // median difference to the relative rotations of the pairs
  double max_front_rotation_deg = 5;  // median difference to a front submap that is warned of
  int min_front_frames = 5;           // that such a comparison needs
  double complete_ratio = 0.95;       // of the images that hang together: a model with so many needs no rival
};

inline void describe(OptionTable& table, BuildOptions& o) {
  table.add("ruminator.colmap", &o.colmap, "COLMAP's program: a name found in PATH, or a path");
  table.add("ruminator.nice", &o.nice, "", "niceness of rebuilding, COLMAP's processes included", 0, 19);
  table.add("ruminator.mapper_time_limit_s", &o.mapper_time_limit_s, "s", "of one run of COLMAP's mapper", 1, 86400);
  table.add("ruminator.sift_keypoints", &o.sift.keypoints, "", "per image, the strongest", 100, 20000);
  table.add("ruminator.sift_contrast", &o.sift.contrast_threshold, "", "least contrast of a keypoint", 0.001, 1);
  table.add("ruminator.sift_low_contrast", &o.sift.low_contrast_threshold, "", "the same for images that show little",
            0.0001, 1);
  table.add("ruminator.match_ratio", &o.matching.max_ratio, "", "distance of the best match over the second best", 0.1,
            1);
  table.add("ruminator.match_near", &o.pairs.near, "images",
            "apart: matched in full; farther pairs if a preview finds something", 1, 100000);
  table.add("ruminator.match_far", &o.pairs.far, "images", "of the farther pairs, the best of each image", 0, 100000);
  table.add("ruminator.match_preview_keypoints", &o.matching.preview_keypoints, "", "the largest ones, in a preview",
            10, 20000);
  table.add("ruminator.match_preview_matches", &o.matching.preview_matches, "", "found by a preview that is followed",
            0, 20000);
  table.add("ruminator.match_min_matches", &o.matching.min_matches, "", "of a pair, for it to be verified", 8, 20000);
  table.add("ruminator.match_min_inliers", &o.matching.min_inliers, "", "of a verified pair", 8, 20000);
  table.add("ruminator.match_max_error_px", &o.matching.max_error_px, "px", "from the epipolar line", 0.1, 20);
  table.add("ruminator.max_error_px", &o.refinement.max_error_px, "px", "of an observation of the model", 0.5, 20);
  table.add("ruminator.min_parallax_deg", &o.refinement.min_parallax_deg, "degrees", "of a point of the model", 0.1,
            20);
  table.add("ruminator.scale_max_change", &o.scale.max_change, "",
            "of the scale along a model, relative; more is a slip and is repaired", 0.01, 10);
  table.add("ruminator.resection_min_inliers", &o.refinement.resection_min_inliers, "",
            "points seen by an image, for it to have a pose", 6, 1000);
  table.add("ruminator.landmark_neighbours", &o.landmarks.neighbours, "images",
            "that each is matched with for the landmarks of the submap", 1, 1000);
  table.add("ruminator.look_images", &o.look_images, "images", "of a long gap, looked at before anything else", 0,
            1000);
  table.add("ruminator.look_min_keypoints", &o.look_min_keypoints, "",
            "in one of them, or the window is given up at once", 0, 20000);
  table.add("ruminator.min_parallax_px", &o.min_parallax_px, "px",
            "median motion beyond a turn of the camera, of some pair of images; else there is nothing to rebuild", 0,
            100);
  table.add("ruminator.max_rmse_px", &o.max_rmse_px, "px", "reprojection error of the model: beyond it it is false",
            0.1, 20);
  table.add("ruminator.max_pair_rotation_deg", &o.max_pair_rotation_deg, "degrees",
            "median difference to the rotations between pairs of images: beyond it the model is false", 0.1, 180);
  table.add("ruminator.max_front_rotation_deg", &o.max_front_rotation_deg, "degrees",
            "median difference to a front submap's rotations: beyond it that submap is warned of", 0.1, 180);
  table.add("ruminator.min_front_frames", &o.min_front_frames, "frames", "that such a comparison needs", 3, 1000);
  table.add("ruminator.complete_ratio", &o.complete_ratio, "",
            "of the images with matches: a model with as many poses needs no rival", 0, 1);
}

}  // namespace rumi
