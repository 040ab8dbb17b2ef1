// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slam/map/submap.h"

namespace rumi {

// Recomputes what a landmark derives from its observations: viewing direction, information and octave0_distance. If it
// is not described yet, chooses its descriptor too: of those observed latest, the one with the least median distance to
// the others.
void update_landmark_view(const Submap& submap, Landmark* landmark);

// Returns the octave at which a landmark should appear from this distance, clamped to the pyramid (Pyramid::scales()).
int predict_octave(const Landmark& landmark, double distance, const std::vector<double>& octave_scales);

// Returns the median depth of the landmarks in the camera, in the submap's unit; 1 if there are none. kNone and unknown
// ids are skipped.
double median_depth(const Submap& submap, const SE3& cam_from_submap, const std::vector<int>& landmark_ids);

}  // namespace rumi
