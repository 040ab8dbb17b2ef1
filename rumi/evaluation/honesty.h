// SPDX-License-Identifier: BSD-3-Clause
// Are poses as well known as they are said to be? Of errors that are drawn from a Gaussian with the deviations told,
// .683 lie within one of them and .954 within two. An error in space lies within them if it is no longer than a
// Gaussian vector is with that probability: 1.88 and 2.83 deviations of one coordinate.
//
// One camera sees neither where the world is nor its unit, and both drift. So a pose is compared with the poses around
// it: those of the same submap within the interval (MetricOptions::rpe_interval_s) before and after it, aligned with
// the truth by a similarity of their own. What is left is how far the pose is off in the map around it (and what the
// unit drifts by within that time), which is what the deviations of position and rotation tell of. The unit's drift is
// measured by itself: how far two steps of the interval that follow each other are apart by the logarithm of their
// lengths, against the truth's, beside what the variance of log scale grew by and what the positions' deviations leave
// of the two lengths.
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
  // Shares of those; absent if there are none.
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
