// SPDX-License-Identifier: BSD-3-Clause
// A truth whose clock is not that of the images: all of its times are early or late by the same.
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

// The shift, of some seconds at most, with which the error is half as large or less. Nothing where there is none, where
// two shifts do nearly as well, where too few poses would keep a truth, or where the path is too even to tell.
std::optional<TruthShift> find_truth_shift(const std::vector<TimedPose>& estimate, const std::vector<TimedPose>& truth,
                                           const MetricOptions& options = {});

}  // namespace rumi::tool
