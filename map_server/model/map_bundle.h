// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment of the served map, or of a window of it (welding, paper section IV.C).
#pragma once

#include <atomic>
#include <vector>

#include "map_server/model/map_model.h"
#include "slam/optimization/bundle_adjustment.h"

namespace rumi::map_server {

struct MapBundleOptions {
  // Each round solves with the observations whose squared error over sigma^2 is below its gate: the first rounds bring
  // together what a rigid alignment left apart, the last one (95 % of a 2-D normal distribution) keeps what fits.
  std::vector<double> gates_chi2 = {400, 36, 5.991};
  int iterations = 50;               // of each round, at most
  double function_tolerance = 1e-5;  // looser tolerances leave slow bends of a long path as they are
  double passing_tolerance = 1e-2;   // the same for a round that another one follows (not for adjustment in pieces)
  int most_views = 1000;             // at once; more are adjusted in pieces
  const std::atomic<bool>* cancel = nullptr;  // true ends it soon
  BundleSolver* solver = nullptr;             // shared by several adjustments in a row, which then cost less
};

struct MapBundleReport {
  int views = 0, points = 0, observations = 0;  // adjusted
  int outliers = 0;                             // observations left out of the last round, and forgotten
  double rmse = 0;                              // of all other observations, in units of their sigma
};

// Adjusts these views (all if empty) and the points that they see; other views that see these points stay fixed, and at
// least one view does. Outliers of the last round are forgotten. A view with fewer than 15 observations (an image that
// is nearly dark, say) is not placed by them; it moves with the view next to it in time.
//
// More than most_views are adjusted in pieces of views that see the same points: in each round one piece after another
// while the others stay, with other pieces in each round. So time and memory grow only with the number of pieces. That
// is as good as one adjustment if a pose graph has brought the map about right before, but it does not straighten slow
// bends of the whole. Outliers of every round are forgotten.
MapBundleReport adjust_map(const std::vector<int>& views, const MapBundleOptions& options, MapModel* model);

}  // namespace rumi::map_server
