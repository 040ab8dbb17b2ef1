// SPDX-License-Identifier: BSD-3-Clause
// Tests whether the standard deviations of poses are honest. If errors are Gaussian with these deviations, .683 of them
// lie within one deviation and .954 within two. A vector counts as within them if it is no longer than a Gaussian
// vector is with that probability: 1.88 and 2.83 deviations of one coordinate.
// One camera observes neither the world's origin nor its unit, and both drift. So a pose is compared with the poses
// around it: those of the same submap within the interval (MetricOptions::rpe_interval_s) before and after it are
// aligned with the truth by a similarity of their own. The remaining difference is the error of the pose relative to
// the map around it (and includes the drift of the unit within that time). The deviations of position and rotation
// describe this error. The drift of the unit is measured separately: the ratio of the lengths of two consecutive steps
// of one interval is compared with the true ratio, in logarithms. The variance of this difference is the growth of the
// variance of log scale, plus the variance of the two lengths.
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
  PoseSigmas sigmas;  // all known, in the unit of the pose
};

struct WithinSigmas {
  int counted = 0;  // number of poses, or of pairs of steps
  // Shares of `counted`; absent if that is 0.
  std::optional<double> one, two;
};

struct Honesty {
  WithinSigmas position, rotation, log_scale;
  std::string reason;  // why a share is absent; empty if none is
};

// `submaps`: the poses of each submap, sorted by time, in a coordinate system and a unit of its own.
Honesty evaluate_honesty(const std::vector<std::vector<ToldPose>>& submaps, const std::vector<TimedPose>& truth,
                         const MetricOptions& options = {});

}  // namespace rumi::tool
