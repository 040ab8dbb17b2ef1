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
  int iterations = 50;                        // of each round, at most
  double function_tolerance = 1e-5;           // looser ones leave the slow bends of a long path where they are
  double passing_tolerance = 1e-2;            // the same of a round that another one follows (in pieces: none)
  int most_views = 1000;                      // at once; more are adjusted in pieces
  const std::atomic<bool>* cancel = nullptr;  // true ends it soon
  BundleSolver* solver = nullptr;             // of adjustments one after another, which then cost less
};

struct MapBundleReport {
  int views = 0, points = 0, observations = 0;  // adjusted
  int outliers = 0;                             // observations left out of the last round, and forgotten
  double rmse = 0;                              // of the others, in units of their sigma
};

// Adjusts these views (all if empty) and the points that they see; other views that see these points stay fixed. At
// least one view is kept fixed. Outliers of the last round are forgotten. A view with fewer than 15 observations (of an
// image that is nearly dark, say) is not placed by them: it goes with the view next to it in time.
// More than most_views are adjusted in pieces that see the same points, in each round one after another while the
// others stay, in other pieces each round: time and memory grow with the number of pieces only. What a pose graph has
// brought about right is as good afterwards; slow bends of the whole it does not straighten. Outliers of every round
// are forgotten.
MapBundleReport adjust_map(const std::vector<int>& views, const MapBundleOptions& options, MapModel* model);

}  // namespace rumi::map_server
