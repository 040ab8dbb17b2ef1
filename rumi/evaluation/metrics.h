// SPDX-License-Identifier: BSD-3-Clause
// Measures how good a trajectory is, from the trajectory, the list of input frames and the truth alone. A figure that
// cannot be computed is absent, never 0, and `reason` says why.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/truth/trajectory.h"
#include "slam/geometry/transform.h"

namespace rumi::tool {

struct MetricOptions {
  double max_time_difference_s = 0.02;  // between a pose and its truth, at most; half the frame period if that is less
  double true_distance_m = 0.10;        // true_rate counts the frames that are no farther than this from the truth
  double rpe_interval_s = 1.0;          // between the two poses whose relative error is measured
  bool truth_has_rotations = true;      // if false, there are no relative errors
};

// Pairs each pose of the estimate with a pose of the truth: at the same time if there is one, else the nearest within
// the tolerance. Returns (index in estimate, index in truth). Both must be sorted by time.
std::vector<std::pair<size_t, size_t>> associate(const std::vector<TimedPose>& estimate,
                                                 const std::vector<TimedPose>& truth,
                                                 const MetricOptions& options = {});

// A pose of the estimate after the Sim(3) alignment, and its truth.
struct PoseError {
  int64_t utime_us = 0;
  Eigen::Vector3d estimate_m, truth_m;  // camera centre, in the truth's frame
  double distance_m = 0;
};

struct TrajectoryMetrics {
  int poses = 0;                         // number of poses in the estimate
  int associated = 0;                    // number of poses that have a truth
  std::optional<double> ate_rmse_m;      // after Sim(3) alignment of all associated poses
  std::optional<double> ate_se3_rmse_m;  // after rigid alignment: the unit of the estimate is taken for a metre
  std::optional<double> rpe_trans_m;     // RMSE of the relative translation over the interval, scale aligned
  std::optional<double> rpe_rot_deg;     // RMSE of the relative rotation over the interval
  std::optional<Sim3> truth_from_estimate;
  double path_m = 0;  // length of the true path through the associated poses
  std::vector<PoseError> errors;
  std::string reason;  // why figures are absent; empty if none is
};

TrajectoryMetrics evaluate_trajectory(const std::vector<TimedPose>& estimate, const std::vector<TimedPose>& truth,
                                      const MetricOptions& options = {});

struct RunMetrics {
  TrajectoryMetrics map;      // the trajectory of the served map
  int frames = 0;             // all input images, also those that are not in frames.csv
  int frames_with_truth = 0;  // frames in frames.csv that have a truth
  int tracked_frames = 0;     // frames with a pose in the served map
  // Both are absent if there are no frames; span_rate also if all frames have the same time.
  std::optional<double> tracked_frame_ratio;
  std::optional<double> span_rate;  // the paper's tracking rate: first to last pose / first to last frame
  // Frames within true_distance_m of the truth / frames that have a truth. Absent if no frame has a truth, if the map
  // has poses but cannot be aligned, or if the whole truth extends no farther than true_distance_m.
  std::optional<double> true_rate;
  std::optional<double> submap_frame_ratio;  // frames with a pose in any submap / all frames
};

// submaps: the trajectories of all submaps, each in its own coordinate system. A pose at a time at which there is no
// frame does not count. images: the number of input images if there were more than `frames`, because a live run had no
// time for some.
RunMetrics evaluate_run(const std::vector<TimedPose>& map, const std::vector<std::vector<TimedPose>>& submaps,
                        const std::vector<InputFrame>& frames, const std::vector<TimedPose>& truth,
                        const MetricOptions& options = {}, int images = 0);

}  // namespace rumi::tool
