// SPDX-License-Identifier: BSD-3-Clause
// The settings of one run of COLMAP's mapper, independent of their names in a version of COLMAP.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace rumi::ruminator {

// The defaults suit windows of some ten to a hundred frames: the models are as good as with COLMAP's own defaults, but
// the mapper is several times as fast.
struct MapperSettings {
  double init_min_tri_angle_deg = 4;  // least median triangulation angle of the points of the first pair; with COLMAP's
                                      // default of 16, no first pair is found if the camera moves slowly
  int init_min_num_inliers = 100;     // least number of inlier matches of the first pair
  int abs_pose_min_num_inliers = 15;  // how many points must agree with an image's pose for it to be registered
  int min_num_matches = 15;           // pairs of images with fewer matches are not used
  double filter_max_reproj_error_px = 4;
  int random_seed = 0;
  bool multiple_models = true;  // false: keeps the model of the first pair, even if it has only two images
  int min_model_size = 10;      // images of a model; smaller ones are dropped (with multiple_models)
  int max_num_models = 3;
  int local_num_images = 5;  // images in a local bundle adjustment
  int local_max_num_iterations = 10;
  int local_max_refinements = 1;
  int global_max_num_iterations = 15;  // most iterations of a global bundle adjustment
  int global_max_refinements = 1;
  double global_growth = 1.4;        // growth in images or points that triggers the next global bundle adjustment
  double function_tolerance = 1e-4;  // tolerance of local and global bundle adjustment
  int threads = 1;                   // with more than one, large models differ from run to run
};

struct MapperCommand {
  std::string database;
  std::string output_folder;         // where the models are written; created if missing, must be empty
  std::string input_model;           // folder of the model to extend; empty: start a new one
  bool fix_existing_images = false;  // true: the images of input_model keep their poses
  std::string log_file;              // COLMAP's output is appended to it
  std::vector<int> keypoint_counts;  // by image of the database
  double cpu_limit_s = 120;
  double time_limit_s = 3600;  // wall clock, in case the mapper hangs
  int nice = 0;
  // Called in the thread of run() with the number of images in the growing model. May be empty.
  std::function<void(int registered)> progress;
};

}  // namespace rumi::ruminator
