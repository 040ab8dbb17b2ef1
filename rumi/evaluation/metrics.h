// SPDX-License-Identifier: BSD-3-Clause
// How good a trajectory is. Everything is computed from the trajectory, the list of input frames and the truth; a
// figure that cannot be computed is absent and `reason` says why: it is never 0.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/truth/trajectory.h"
#include "slam/geometry/transform.h"

namespace rumi::tool {

struct MetricOptions {
  double max_time_difference_s = 0.02;  // between a pose and its truth; never more than half the frame period
  double true_distance_m = 0.10;        // true_rate counts the frames nearer to the truth than this
  double rpe_interval_s = 1.0;          // between the two poses that a relative error compares
  bool truth_has_rotations = true;      // without them there are no relative errors
};

// Pairs (index in estimate, index in truth): the same time if the truth has it, else the nearest within the tolerance.
// Both must be sorted by time.
std::vector<std::pair<size_t, size_t>> associate(const std::vector<TimedPose>& estimate,
                                                 const std::vector<TimedPose>& truth,
                                                 const MetricOptions& options = {});

// One pose of the estimate against the truth, after Sim(3) alignment.
struct PoseError {
  int64_t utime_us = 0;
  Eigen::Vector3d estimate_m, truth_m;  // camera centre, in the truth's frame
  double distance_m = 0;
};

struct TrajectoryMetrics {
  int poses = 0;                         // in the estimate
  int associated = 0;                    // poses with a truth
  std::optional<double> ate_rmse_m;      // after Sim(3) alignment of all associated poses
  std::optional<double> ate_se3_rmse_m;  // after rigid alignment: the unit of the estimate is taken for a metre
  std::optional<double> rpe_trans_m;     // RMSE of the relative translation over the interval, scale aligned
  std::optional<double> rpe_rot_deg;     // RMSE of the relative rotation over the interval
  std::optional<Sim3> truth_from_estimate;
  double path_m = 0;  // length of the true path from one associated pose to the next
  std::vector<PoseError> errors;
  std::string reason;  // why figures are absent
};

TrajectoryMetrics evaluate_trajectory(const std::vector<TimedPose>& estimate, const std::vector<TimedPose>& truth,
                                      const MetricOptions& options = {});

struct RunMetrics {
  TrajectoryMetrics map;      // the trajectory of the served map
  int frames = 0;             // all input frames
  int frames_with_truth = 0;  // frames in frames.csv with a truth
  int tracked_frames = 0;     // with a pose in the served map
  // Absent without frames.
  std::optional<double> tracked_frame_ratio;
  std::optional<double> span_rate;  // the paper's tracking rate: first to last pose / first to last frame
  // Frames within true_distance_m / frames that have a truth; absent if the whole true path is shorter than that.
  std::optional<double> true_rate;
  std::optional<double> submap_frame_ratio;  // frames with a pose in any submap / all frames
};

// submaps: the trajectories of all submaps, each in its own frame. Poses at times of no frame do not count.
// images: number of images, if more than frames: a live run may have had no time for some.
RunMetrics evaluate_run(const std::vector<TimedPose>& map, const std::vector<std::vector<TimedPose>>& submaps,
                        const std::vector<InputFrame>& frames, const std::vector<TimedPose>& truth,
                        const MetricOptions& options = {}, int images = 0);

}  // namespace rumi::tool
