// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/options.h"
#include "bus/wire/working_image.h"
#include "ruminator/build/back_landmarks.h"
#include "ruminator/matching/sift_features.h"
#include "ruminator/matching/window_matches.h"
#include "ruminator/model/global_model.h"
#include "ruminator/model/model_joining.h"
#include "ruminator/model/model_refinement.h"
#include "ruminator/model/scale_check.h"
#include "ruminator/model/torn_model.h"

namespace rumi::ruminator {

// How a window is rebuilt.
struct BuildOptions {
  std::string colmap = "colmap";              // the program: a name found in PATH or a path
  int nice = 19;                              // of COLMAP's processes and of our own building thread
  double mapper_cpu_limit_s = 120;            // of one mapper run
  double mapper_time_limit_s = 3600;          // the same on the wall clock, against a mapper that hangs
  int max_image_side = kDefaultMaxImageSide;  // pixels; larger images are worked on smaller, as by front_tracker
  SiftOptions sift;
  SiftMatchOptions matching;
  PairSelection pairs;
  GlobalModelOptions global;
  ModelRefinementOptions refinement;
  ScaleCheckOptions scale;
  TearOptions tear;
  JoiningOptions joining;
  BackLandmarkOptions landmarks;
  int look_images = 6;                    // of a long gap, looked at first
  int look_min_keypoints = 50;            // in one of them, or the gap is blind
  double min_parallax_px = 2;             // of some pair of images, or the camera has only turned
  double max_rmse_px = 1.5;               // of the reprojection
  double max_pair_rotation_deg = 3;       // median difference to the relative rotations of the pairs
  double max_front_rotation_deg = 5;      // median difference to a front submap that is warned of
  double max_rival_position_ratio = 0.1;  // difference of a model that COLMAP began to the global one: FrontAgreement
  int min_front_frames = 5;               // that such a comparison needs
  double complete_ratio = 0.95;           // of the images that hang together: a model with so many needs no rival
};

inline void describe(OptionTable& table, BuildOptions& o) {
  table.group("colmap");
  table.add("ruminator.colmap", &o.colmap, "COLMAP's program: a name found in PATH, or a path");
  table.add("ruminator.nice", &o.nice, "", "niceness of rebuilding, COLMAP's processes included", 0, 19);
  table.add("ruminator.mapper_cpu_limit_s", &o.mapper_cpu_limit_s, "s", "CPU time of one run of COLMAP's mapper", 1,
            86400);
  table.add("ruminator.mapper_time_limit_s", &o.mapper_time_limit_s, "s",
            "the same on the wall clock, against a mapper that hangs: other programs may have the cores", 1, 864000);
  table.add("ruminator.max_image_side", &o.max_image_side, "px",
            "larger images are worked on at this size; 0: never; front_tracker's must be the same", 0, 100000);
  table.group("matching");
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
  table.group("model");
  table.add("ruminator.resection_min_inliers", &o.refinement.resection_min_inliers, "",
            "points seen by an image, for it to have a pose", 6, 1000);
  table.add("ruminator.max_error_px", &o.refinement.max_error_px, "px", "of an observation of the model", 0.5, 20);
  table.add("ruminator.min_parallax_deg", &o.refinement.min_parallax_deg, "degrees", "of a point of the model", 0.1,
            20);
  table.add("ruminator.scale_max_change", &o.scale.max_change, "",
            "of the scale along a model, relative; more is a slip and is repaired", 0.01, 10);
  table.add("ruminator.global_min_pair_matches", &o.global.min_pair_matches, "",
            "of a pair of images, for a relative rotation", 8, 20000);
  table.add("ruminator.global_max_rotation_error_deg", &o.global.max_rotation_error_deg, "degrees",
            "between a pair and the averaged rotations; beyond it the pair is not used", 0.1, 180);
  table.add("ruminator.global_min_track_images", &o.global.min_track_images, "images",
            "that see a point of the global model", 2, 1000);
  table.add("ruminator.global_tracks_per_image", &o.global.tracks_per_image, "",
            "points of the global model in each image, at least", 10, 20000);
  table.add("ruminator.global_iterations", &o.global.iterations, "", "of placing cameras and points, at most", 1,
            10000);
  table.add("ruminator.scale_min_parallax_deg", &o.scale.min_parallax_deg, "degrees",
            "of a point on either side of a cut, where scales are compared", 0.01, 20);
  table.add("ruminator.scale_max_error_px", &o.scale.max_error_px, "px", "of its observations", 0.1, 20);
  table.add("ruminator.scale_min_points", &o.scale.min_points, "", "that tell of a slip of the scale", 3, 10000);
  table.add("ruminator.scale_max_log_error", &o.scale.max_log_error, "",
            "of what they tell: the standard error of the logarithm", 0.001, 10);
  table.add("ruminator.scale_min_carrying_points", &o.scale.min_carrying_points, "",
            "across a cut, for the scale to be carried over it", 1, 10000);
  table.add("ruminator.scale_max_carried_log_error", &o.scale.max_carried_log_error, "",
            "of what they tell: the standard error of the logarithm", 0.001, 10);
  table.add("ruminator.scale_certain_points", &o.scale.certain_points, "",
            "across a cut, that say more of the scale than front_tracker's poses", 1, 10000);
  table.add("ruminator.scale_certain_log_error", &o.scale.certain_log_error, "",
            "of what they tell: the standard error of the logarithm", 0.001, 10);
  table.add("ruminator.scale_min_depth_points", &o.scale.min_depth_points, "",
            "that a side of a cut sees by itself, for it to have a scale", 1, 10000);
  table.add("ruminator.scale_repairs", &o.scale.repairs, "", "of slips of the scale in one model, at most", 0, 100);
  table.add("ruminator.tear_min_matches", &o.tear.min_matches, "",
            "of two images, that a model contradicts to be torn between them", 5, 10000);
  table.add("ruminator.tear_max_severed", &o.tear.max_severed, "",
            "part of two images' matches that a model may contradict", 0.01, 1);
  table.add("ruminator.tear_max_severed_adrift", &o.tear.max_severed_adrift, "",
            "the same where else no part is left that front_tracker knows enough images of", 0.01, 1);
  table.add("ruminator.tear_max_severed_ratio", &o.tear.max_severed_ratio, "",
            "times that part in the whole model, which it may be too", 1, 1000);
  table.add("ruminator.tear_regrow_parallax_deg", &o.tear.regrow_parallax_deg, "degrees",
            "of the points that tie what was torn off to the rest", 0.01, 20);
  table.add("ruminator.tear_regrow_images", &o.tear.regrow_images, "images", "placed anew between two adjustments", 1,
            1000);
  table.add("ruminator.join_min_points", &o.joining.min_points, "", "that two models must place alike to be joined", 3,
            10000);
  table.add("ruminator.join_min_share", &o.joining.min_share, "", "of the points that both place, the same", 0, 1);
  table.add("ruminator.join_max_error_px", &o.joining.max_error_px, "px",
            "of a point of one model in the images of the other", 0.1, 100);
  table.add("ruminator.join_samples", &o.joining.samples, "", "of three points, in search of the transform", 1, 100000);
  table.add("ruminator.join_front_max_position_ratio", &o.joining.front_max_position_ratio, "",
            "distance to a front submap over the spread of the positions, for the submap to join two sides", 0.001, 1);
  table.add("ruminator.join_front_max_rotation_deg", &o.joining.front_max_rotation_deg, "degrees",
            "the same of rotations", 0.1, 180);
  table.group("build");
  table.add("ruminator.landmark_max_distance", &o.landmarks.max_distance, "", "of the descriptors of a match, Hamming",
            1, 256);
  table.add("ruminator.landmark_max_line_px", &o.landmarks.max_line_px, "px", "of a match from the epipolar line", 0.1,
            100);
  table.add("ruminator.landmark_max_error_px", &o.landmarks.max_error_px, "px", "of an observation of a landmark", 0.1,
            100);
  table.add("ruminator.landmark_min_parallax_deg", &o.landmarks.min_parallax_deg, "degrees", "of a landmark", 0.01, 20);
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
  table.add("ruminator.max_rival_position_ratio", &o.max_rival_position_ratio, "",
            "difference of a model that COLMAP's mapper began alone to a credible global one, over the spread of the "
            "positions: beyond it it is false",
            0.001, 10);
  table.add("ruminator.min_front_frames", &o.min_front_frames, "frames", "that such a comparison needs", 3, 1000);
  table.add("ruminator.complete_ratio", &o.complete_ratio, "",
            "of the images with matches: a model with as many poses needs no rival", 0, 1);
}

}  // namespace rumi::ruminator
