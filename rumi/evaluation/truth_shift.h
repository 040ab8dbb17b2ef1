// SPDX-License-Identifier: BSD-3-Clause
// Finds out whether the clock of the truth differs from that of the images: all of its times are early or late by the
// same amount.
#pragma once

#include <optional>
#include <vector>

#include "formats/truth/trajectory.h"
#include "rumi/evaluation/metrics.h"

namespace rumi::tool {

struct TruthShift {
  double seconds = 0;  // to be added to the times of the truth
  double ate_rmse_m = 0;
};

std::vector<TimedPose> shifted(std::vector<TimedPose> truth, double seconds);

// Returns the shift, of at most ten seconds, that makes the error half as large or less. Absent if there is no such
// shift, if two shifts are nearly as good, if too few poses would keep a truth, or if the path is too even to tell.
std::optional<TruthShift> find_truth_shift(const std::vector<TimedPose>& estimate, const std::vector<TimedPose>& truth,
                                           const MetricOptions& options = {});

}  // namespace rumi::tool
