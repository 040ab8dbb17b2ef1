// SPDX-License-Identifier: BSD-3-Clause
// Tests whether a rebuilt window agrees with front_tracker's poses. front_tracker tracked the approach and the
// departure each in one submap, so there the window and the submap must have the same shape.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ruminator/window/rumination_window.h"

namespace rumi::ruminator {

constexpr size_t kMinFrontFrames = 5;  // least number of frames for a comparison

struct FrontAgreement {
  int32_t submap_id = kNoSubmap;
  int frames = 0;           // number of frames with a pose in both
  double rotation_deg = 0;  // median difference of the rotations after alignment
  // RMS distance after Sim(3) alignment, over the RMS distance of the positions from their mean.
  double position_ratio = 0;
};

// Returns one entry for each front submap in which at least kMinFrontFrames samples with a pose in the model were
// tracked, ordered by id. `cam_from_model`: the model's poses by utime.
std::vector<FrontAgreement> compare_with_front(const std::vector<Sample>& samples,
                                               const std::map<int64_t, SE3>& cam_from_model);

}  // namespace rumi::ruminator
