// SPDX-License-Identifier: BSD-3-Clause
// Brings two models of one window into the same unit and frame of reference, by the points that both have or by
// front_tracker's poses.
#pragma once

#include <optional>
#include <vector>

#include "ruminator/matching/tracks.h"
#include "ruminator/matching/window_image.h"
#include "ruminator/model/front_agreement.h"
#include "ruminator/model/sparse_model.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

// Computes a_from_b from the tracks for which both models have a point. Returns nullopt if too few agree.
// Deterministic.
std::optional<Sim3> align_models(const Camera& camera, const std::vector<WindowImage>& images,
                                 const std::vector<Track>& tracks, const SparseModel& a, const SparseModel& b);

// Returns the images of both models. An image in both keeps its pose in `a`. The result has no points: they must be
// triangulated again.
SparseModel join_models(const Sim3& a_from_b, const SparseModel& a, const SparseModel& b);

// Computes before_from_after by way of a front submap. Each model must have at least kMinFrontFrames of the frames that
// were tracked in it, and agree with it. Returns nullopt if there is no such submap. `utimes_us`: times of the images.
std::optional<Sim3> front_tie(const std::vector<Sample>& front, const std::vector<int64_t>& utimes_us,
                              const SparseModel& before, const SparseModel& after);

}  // namespace rumi::ruminator
