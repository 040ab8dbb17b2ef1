// SPDX-License-Identifier: BSD-3-Clause
// Weights the landmarks for a frame's pose. Many landmarks close together in the image are usually on one object: they
// have errors in common, and move together if it moves. So each part of the image has the same weight, however many
// landmarks it has: a lorry full of lettering does not outvote a street with few corners.
#pragma once

#include <vector>

#include "slam/optimization/pose_optimizer.h"

namespace rumi::front_tracker {

// Sets the weights. They have the same sum in each square cell of the image that has an observation, and a mean of 1
// over all observations.
void weigh_by_area(const Camera& camera, std::vector<PointObservation>* observations);

}  // namespace rumi::front_tracker
