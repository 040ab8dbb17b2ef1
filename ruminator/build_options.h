// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bus/options.h"

namespace rumi {

// How a window is rebuilt.
struct BuildOptions {
  std::string colmap = "colmap";     // the program: a name found in PATH or a path
  int nice = 19;                     // of COLMAP's processes and of our own building thread
  double mapper_time_limit_s = 120;  // of one mapper run
  int sift_keypoints = 1000;         // per image
};

inline void describe(OptionTable& table, BuildOptions& o) {
  table.add("ruminator.colmap", &o.colmap, "COLMAP's program: a name found in PATH, or a path");
  table.add("ruminator.nice", &o.nice, "", "niceness of rebuilding, COLMAP's processes included", 0, 19);
  table.add("ruminator.mapper_time_limit_s", &o.mapper_time_limit_s, "s", "of one run of COLMAP's mapper", 1, 86400);
  table.add("ruminator.sift_keypoints", &o.sift_keypoints, "", "per image", 100, 20000);
}

}  // namespace rumi
