// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment of the served map, or of a window of it (welding, paper section IV.C).
#pragma once

#include <atomic>
#include <vector>

#include "map_server/model/map_model.h"
#include "slam/optimization/bundle_adjustment.h"

namespace rumi::map_server {

struct MapBundleOptions {
  // Each round uses the observations whose squared error over sigma^2 is below its gate. The first rounds close the
  // gaps that a rigid alignment left, the last one (95 % of a 2-D normal distribution) keeps only observations that
  // fit.
  std::vector<double> gates_chi2 = {400, 36, 5.991};
  int iterations = 50;                        // most iterations of each round
  double function_tolerance = 1e-5;           // looser tolerances do not straighten slow bends of a long path
  double passing_tolerance = 1e-2;            // function_tolerance of a round that another one follows; not in pieces
  int most_views = 1000;                      // most views that are adjusted at once; more are divided into pieces
  const std::atomic<bool>* cancel = nullptr;  // becomes true to end the adjustment soon
  BundleSolver* solver = nullptr;             // makes several adjustments in a row faster, if they share it
};

struct MapBundleReport {
  int views = 0, points = 0, observations = 0;  // how many were adjusted
  int outliers = 0;                             // observations rejected in the last round, and removed from the model
  double rmse = 0;                              // root mean square error of all other observations, over their sigma
};

// Adjusts these views (all if empty) and the points that they see. Other views that see these points stay fixed, and at
// least one view does. Outliers of the last round are removed. A view with fewer than 15 observations (for example an
// almost dark image) is not placed by them, but moves along with the view next to it in time.
//
// More than most_views views are adjusted in pieces of views that see the same points: in each round one piece after
// another, while the other views stay fixed, with other borders in each round. Time and memory then grow only with the
// number of pieces. If a pose graph has brought the map about right before, the result is as good as that of one
// adjustment, except that slow bends of the whole are not straightened. Outliers of every round are removed.
MapBundleReport adjust_map(const std::vector<int>& views, const MapBundleOptions& options, MapModel* model);

}  // namespace rumi::map_server
