// SPDX-License-Identifier: BSD-3-Clause
// How much each landmark counts for a frame's pose. Many landmarks close together in the image are on one thing: they
// err together, and if it moves, they move together. So each part of the image has one voice, however many landmarks
// are in it: a lorry full of lettering does not outvote a street with few corners.
#pragma once

#include <vector>

#include "slam/optimization/pose_optimizer.h"

namespace rumi::front_tracker {

// Sets the weights: the same sum for each square cell of the image that has an observation, 1 in the mean over the
// observations.
void weigh_by_area(const Camera& camera, std::vector<PointObservation>* observations);

}  // namespace rumi::front_tracker
