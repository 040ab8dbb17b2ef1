// SPDX-License-Identifier: BSD-3-Clause
// Two models of one window in one unit and one frame: from what both see, or from the poses that front_tracker had.
#pragma once

#include <optional>
#include <vector>

#include "ruminator/matching/tracks.h"
#include "ruminator/matching/window_image.h"
#include "ruminator/model/front_agreement.h"
#include "ruminator/model/sparse_model.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

// a_from_b, from the tracks that both models have points of; nothing where too few agree. Deterministic.
std::optional<Sim3> align_models(const Camera& camera, const std::vector<WindowImage>& images,
                                 const std::vector<Track>& tracks, const SparseModel& a, const SparseModel& b);

// The images of both: those that both have a pose of as in `a`. Without points: they are to be triangulated anew.
SparseModel join_models(const Sim3& a_from_b, const SparseModel& a, const SparseModel& b);

// before_from_after: two models put to each other as the frames of one front submap in both of them tell. Nothing where
// there are fewer than kMinFrontFrames in a model, or where a model disagrees with the submap. utimes: of the images.
std::optional<Sim3> front_tie(const std::vector<Sample>& front, const std::vector<int64_t>& utimes_us,
                              const SparseModel& before, const SparseModel& after);

}  // namespace rumi::ruminator
