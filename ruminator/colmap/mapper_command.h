// SPDX-License-Identifier: BSD-3-Clause
// The settings of one run of COLMAP's mapper, independent of the names that a version of COLMAP has for them.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace rumi::ruminator {

// The defaults are for windows of some ten to a hundred frames. For these they are as good as COLMAP's own and several
// times as fast.
struct MapperSettings {
  double init_min_tri_angle_deg = 4;  // median angle of the first pair's points; COLMAP's 16 fails in slow motion
  int init_min_num_inliers = 100;     // matches of the first pair
  int abs_pose_min_num_inliers = 15;  // points seen by an image that is registered
  int min_num_matches = 15;           // a pair with fewer is not used
  double filter_max_reproj_error_px = 4;
  int random_seed = 0;
  bool multiple_models = true;  // false: keep the model of the first pair, even of two images
  int min_model_size = 10;      // images; smaller models are dropped (with multiple_models)
  int max_num_models = 3;
  int local_num_images = 5;  // in local bundle adjustment
  int local_max_num_iterations = 10;
  int local_max_refinements = 1;
  int global_max_num_iterations = 15;  // in global bundle adjustment
  int global_max_refinements = 1;
  double global_growth = 1.4;        // growth in images or points from one global bundle adjustment to the next
  double function_tolerance = 1e-4;  // of both adjustments
  int threads = 1;                   // with more, large models differ from run to run
};

struct MapperCommand {
  std::string database;
  std::string output_folder;         // created if missing; must be empty. The models are written there
  std::string input_model;           // folder of the model to extend; empty: start anew
  bool fix_existing_images = false;  // those of input_model keep their poses
  std::string log_file;              // appended to
  std::vector<int> keypoint_counts;  // per image of the database
  double cpu_limit_s = 120;
  double time_limit_s = 3600;  // wall clock, against a mapper that hangs
  int nice = 0;
  // Called in this thread with the number of images registered in the model that is growing. May be empty.
  std::function<void(int registered)> progress;
};

}  // namespace rumi::ruminator
