// SPDX-License-Identifier: BSD-3-Clause
// Tests whether the scale of a model is the same from its beginning to its end. If a camera rotates more than it moves,
// the parts before and after that can have different units. The reprojection errors stay small all the same, because
// the points that would reveal it are treated as outliers.
#pragma once

#include <optional>
#include <vector>

#include "ruminator/matching/tracks.h"
#include "ruminator/matching/window_image.h"
#include "ruminator/model/model_refinement.h"
#include "ruminator/model/sparse_model.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

constexpr double kMaxScaleChange = 0.25;  // a smaller relative change of the scale along a model is no slip

struct ScaleCut {
  int image = 0;   // last image before the cut
  int tracks = 0;  // tracks that cross the cut
  int points = 0;  // tracks among them that each side can triangulate by itself
  // Whether both sides have depth, but too few points connect their scales.
  bool is_break = false;
  // Both sides can triangulate these points. The ratio of a point's distances from the camera of `image`, after the cut
  // over before it: median logarithm and standard error.
  double log_ratio = 0, log_error = 0;
  double log_spread = 0;  // largest distance of a logarithm from the median
};

// Returns a cut after each registered image except the last. `tracks`: all tracks, even those without a point in the
// model.
std::vector<ScaleCut> check_scale(const Camera& camera, const std::vector<WindowImage>& images,
                                  const std::vector<Track>& tracks, const SparseModel& model);

// True if the points across the cut determine the scale well enough without front_tracker's poses.
bool is_certain(const ScaleCut& cut);

// Returns the cut with the largest significant change of the scale; nullopt if no such change exceeds `max_change`.
std::optional<ScaleCut> find_slip(const std::vector<ScaleCut>& cuts, double max_change = kMaxScaleChange);

// Returns the break with fewest points, and among equal ones that with fewest tracks; nullopt if there is no break.
std::optional<ScaleCut> find_break(const std::vector<ScaleCut>& cuts);

// Removes the images on the side of the cut that has fewer. Returns their number.
int keep_larger_side(const ScaleCut& cut, SparseModel* model);

// Scales all camera positions after the cut to the scale before it, with the camera of cut.image as the centre.
// Afterwards the points must be triangulated again.
void repair_scale(const ScaleCut& cut, SparseModel* model);

}  // namespace rumi::ruminator
