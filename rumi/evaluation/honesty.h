// SPDX-License-Identifier: BSD-3-Clause
// Tests whether the standard deviations of poses are honest. If errors are Gaussian with these deviations, .683 of them
// lie within one deviation and .954 within two. A vector counts as within them up to the length that a Gaussian vector
// keeps with that probability: 1.88 and 2.83 deviations of one coordinate.
//
// One camera sees neither where the world is nor its unit, and both drift. So a pose is compared with the poses around
// it: those of the same submap within the interval (MetricOptions::rpe_interval_s) before and after it, aligned with
// the truth by a similarity of their own. The rest is the error of the pose in the map around it (with the drift of the
// unit within that time), which the deviations of position and rotation describe. The drift of the unit is measured
// separately: two consecutive steps of one interval are compared by the logarithm of their lengths, against the
// truth's. Its variance is the growth of the variance of log scale, plus the variance of the two lengths.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/truth/trajectory.h"
#include "rumi/evaluation/metrics.h"
#include "slam/map/pose_sigmas.h"

namespace rumi::tool {

struct ToldPose {
  TimedPose pose;
  PoseSigmas sigmas;  // known, in the pose's unit
};

struct WithinSigmas {
  int counted = 0;  // poses, or pairs of steps
  // Shares of `counted`; absent if that is 0.
  std::optional<double> one, two;
};

struct Honesty {
  WithinSigmas position, rotation, log_scale;
  std::string reason;  // why one is absent
};

// One list of poses a submap, each by time and in a frame and a unit of its own.
Honesty evaluate_honesty(const std::vector<std::vector<ToldPose>>& submaps, const std::vector<TimedPose>& truth,
                         const MetricOptions& options = {});

}  // namespace rumi::tool
