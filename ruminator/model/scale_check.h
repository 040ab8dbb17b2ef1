// SPDX-License-Identifier: BSD-3-Clause
// Is the scale of a model the same from its beginning to its end? Where a camera turns more than it moves, the two
// sides of the turn can have different units. The reprojection errors stay small all the same, because the points that
// would show it are treated as outliers.
#pragma once

#include <optional>
#include <vector>

#include "ruminator/matching/tracks.h"
#include "ruminator/matching/window_image.h"
#include "ruminator/model/model_refinement.h"
#include "ruminator/model/sparse_model.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

constexpr double kMaxScaleChange = 0.25;  // largest relative change of the scale along a model that is no slip

struct ScaleCut {
  int image = 0;   // the last one before the cut
  int tracks = 0;  // tracks that cross the cut
  int points = 0;  // tracks among them that either side can triangulate by itself
  // Both sides see depth, but too few points connect the scale of one side with that of the other.
  bool is_break = false;
  // Both sides triangulate such a point. The ratio of its distances from `image`, after the cut over before it: median
  // logarithm and standard error.
  double log_ratio = 0, log_error = 0;
  double log_spread = 0;  // how far the farthest logarithm is from the median
};

// Returns a cut after every registered image but the last. `tracks`: all tracks, also those without a point in the
// model.
std::vector<ScaleCut> check_scale(const Camera& camera, const std::vector<WindowImage>& images,
                                  const std::vector<Track>& tracks, const SparseModel& model);

// True if the points across the cut determine the scale well enough without front_tracker's poses.
bool is_certain(const ScaleCut& cut);

// Returns the cut where the scale certainly changes, and changes most; nothing if it does not change.
std::optional<ScaleCut> find_slip(const std::vector<ScaleCut>& cuts, double max_change = kMaxScaleChange);

// Returns the break with the fewest points, and among equal ones that with the fewest tracks; nothing without a break.
std::optional<ScaleCut> find_break(const std::vector<ScaleCut>& cuts);

// Removes the images on the smaller side of the cut. Returns their number.
int keep_larger_side(const ScaleCut& cut, SparseModel* model);

// Scales everything after the cut to the scale before it, about the image of the cut. Triangulate the points anew after
// it.
void repair_scale(const ScaleCut& cut, SparseModel* model);

}  // namespace rumi::ruminator
