// SPDX-License-Identifier: BSD-3-Clause
// Does a rebuilt window agree with front_tracker's poses? front_tracker tracked the approach and the departure, each in
// one submap, so the window and the submap must have the same shape there.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ruminator/window/rumination_window.h"

namespace rumi::ruminator {

constexpr size_t kMinFrontFrames = 5;  // a comparison needs so many frames

struct FrontAgreement {
  int32_t submap_id = kNoSubmap;
  int frames = 0;           // frames with a pose in both
  double rotation_deg = 0;  // median difference after alignment
  // RMS distance after Sim(3) alignment over the spread (RMS from the mean) of the positions.
  double position_ratio = 0;
};

// Returns one entry for each front submap in which at least kMinFrontFrames of the samples have a pose, in order of id.
// `cam_from_model`: poses by utime.
std::vector<FrontAgreement> compare_with_front(const std::vector<Sample>& samples,
                                               const std::map<int64_t, SE3>& cam_from_model);

}  // namespace rumi::ruminator
