// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/metrics.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "slam/geometry/alignment.h"
#include "slam/numeric/median.h"

namespace rumi::tool {
namespace {

int64_t median_period_us(const std::vector<TimedPose>& poses) {
  std::vector<int64_t> periods;
  for (size_t i = 1; i < poses.size(); ++i) periods.push_back(poses[i].utime_us - poses[i - 1].utime_us);
  if (periods.empty()) return 0;
  return median(&periods);
}

// Returns the diagonal of the box that holds the path.
double extent(const std::vector<TimedPose>& path) {
  Eigen::AlignedBox3d box;
  for (const TimedPose& pose : path) box.extend(pose.map_from_cam.translation);
  return path.empty() ? 0 : box.sizes().norm();
}

double rmse(const std::vector<double>& values) {
  double sum = 0;
  for (double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double rmse_after(const Sim3& truth_from_estimate, const std::vector<Eigen::Vector3d>& estimate,
                  const std::vector<Eigen::Vector3d>& truth) {
  std::vector<double> distances;
  for (size_t i = 0; i < truth.size(); ++i) distances.push_back((truth_from_estimate * estimate[i] - truth[i]).norm());
  return rmse(distances);
}

// True if the path does not move. Then it has neither size nor direction to be aligned by.
bool is_one_place(const std::vector<Eigen::Vector3d>& places) {
  constexpr double kSmallest = 1e-6;  // m between two poses
  return std::all_of(places.begin(), places.end(),
                     [&places](const Eigen::Vector3d& place) { return (place - places[0]).norm() < kSmallest; });
}

// Compares the motion over the interval, from every pose that has another pose one interval later. That pose may be
// late by one frame period, because a frame may be missing, but not by more.
void relative_errors(const std::vector<TimedPose>& estimate, const std::vector<TimedPose>& truth,
                     const std::vector<std::pair<size_t, size_t>>& pairs, double scale, const MetricOptions& options,
                     TrajectoryMetrics* metrics) {
  const auto interval_us = std::llround(options.rpe_interval_s * 1e6);
  const int64_t slack_us = std::max<int64_t>(1000, median_period_us(estimate));
  std::vector<double> translations, rotations;
  size_t later = 0;
  for (const auto& [e0, t0] : pairs) {
    const int64_t wanted_us = estimate[e0].utime_us + interval_us;
    // The later pose may be a millisecond too early: periods such as 33,333 us do not add up to a second.
    while (later < pairs.size() && estimate[pairs[later].first].utime_us < wanted_us - 1000) ++later;
    if (later == pairs.size()) break;
    const auto& [e1, t1] = pairs[later];
    if (estimate[e1].utime_us > wanted_us + slack_us) continue;
    SE3 moved = estimate[e0].map_from_cam.inverse() * estimate[e1].map_from_cam;
    moved.translation *= scale;
    const SE3 true_moved = truth[t0].map_from_cam.inverse() * truth[t1].map_from_cam;
    const SE3 error = true_moved.inverse() * moved;
    translations.push_back(error.translation.norm());
    rotations.push_back(error.angle_rad() * 180.0 / std::numbers::pi);
  }
  if (translations.empty()) {
    metrics->reason = fmt::format("no two poses {} s apart: no relative error", options.rpe_interval_s);
    return;
  }
  metrics->rpe_trans_m = rmse(translations);
  metrics->rpe_rot_deg = rmse(rotations);
}

// Sets the errors after alignment. Returns why there are none, or an empty string if there are.
std::string absolute_errors(const std::vector<Eigen::Vector3d>& estimated, const std::vector<Eigen::Vector3d>& actual,
                            TrajectoryMetrics* metrics) {
  if (is_one_place(actual))
    return fmt::format(
        "the truth of all {} poses is one and the same place: did the tracker stand still, or are these other columns?",
        actual.size());
  const std::optional<Sim3> similarity = umeyama(estimated, actual, true);
  const std::optional<Sim3> rigid = umeyama(estimated, actual, false);
  if (!similarity || !rigid) return fmt::format("{} poses that all are in one place cannot be aligned", actual.size());
  const double ate_m = rmse_after(*similarity, estimated, actual), rigid_m = rmse_after(*rigid, estimated, actual);
  if (!std::isfinite(ate_m) || !std::isfinite(rigid_m)) return "some positions are too large to be computed with";
  metrics->truth_from_estimate = *similarity;
  metrics->ate_rmse_m = ate_m;
  metrics->ate_se3_rmse_m = rigid_m;
  return {};
}

double true_rate_of(const RunMetrics& metrics, const std::set<int64_t>& times, double true_distance_m) {
  int true_frames = 0;
  for (const PoseError& error : metrics.map.errors)
    if (error.distance_m <= true_distance_m) true_frames += static_cast<int>(times.count(error.utime_us));
  // Images without a time are taken to have a truth as often as the others.
  const double may_be_true =
      static_cast<double>(metrics.frames) * metrics.frames_with_truth / static_cast<double>(times.size());
  return std::min(1.0, true_frames / may_be_true);
}

}  // namespace

std::vector<std::pair<size_t, size_t>> associate(const std::vector<TimedPose>& estimate,
                                                 const std::vector<TimedPose>& truth, const MetricOptions& options) {
  int64_t tolerance_us = std::llround(options.max_time_difference_s * 1e6);
  const int64_t period_us = median_period_us(estimate);
  if (period_us > 0) tolerance_us = std::min(tolerance_us, period_us / 2);
  std::vector<std::pair<size_t, size_t>> pairs;
  const auto distance = [&](size_t t, int64_t utime_us) { return std::abs(truth[t].utime_us - utime_us); };
  size_t t = 0;
  for (size_t e = 0; e < estimate.size() && !truth.empty(); ++e) {
    const int64_t utime_us = estimate[e].utime_us;
    while (t + 1 < truth.size() && distance(t + 1, utime_us) <= distance(t, utime_us)) ++t;
    if (distance(t, utime_us) <= tolerance_us) pairs.emplace_back(e, t);
  }
  return pairs;
}

TrajectoryMetrics evaluate_trajectory(const std::vector<TimedPose>& estimate, const std::vector<TimedPose>& truth,
                                      const MetricOptions& options) {
  TrajectoryMetrics metrics;
  metrics.poses = static_cast<int>(estimate.size());
  const auto pairs = associate(estimate, truth, options);
  metrics.associated = static_cast<int>(pairs.size());
  if (pairs.size() < 3) {
    metrics.reason = fmt::format("{} of {} poses have a truth; an alignment needs 3", pairs.size(), estimate.size());
    return metrics;
  }
  std::vector<Eigen::Vector3d> estimated, actual;
  for (const auto& [e, t] : pairs) {
    estimated.push_back(estimate[e].map_from_cam.translation);
    actual.push_back(truth[t].map_from_cam.translation);
  }
  for (size_t i = 1; i < actual.size(); ++i) metrics.path_m += (actual[i] - actual[i - 1]).norm();
  metrics.reason = absolute_errors(estimated, actual, &metrics);
  if (!metrics.reason.empty()) return metrics;
  const Sim3& aligned_by = *metrics.truth_from_estimate;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d aligned = aligned_by * estimated[i];
    metrics.errors.push_back({estimate[pairs[i].first].utime_us, aligned, actual[i], (aligned - actual[i]).norm()});
  }
  if (options.truth_has_rotations)
    relative_errors(estimate, truth, pairs, aligned_by.scale, options, &metrics);
  else
    metrics.reason = "the truth has no rotations";
  return metrics;
}

RunMetrics evaluate_run(const std::vector<TimedPose>& map, const std::vector<std::vector<TimedPose>>& submaps,
                        const std::vector<InputFrame>& frames, const std::vector<TimedPose>& truth,
                        const MetricOptions& options, int images) {
  RunMetrics metrics;
  metrics.map = evaluate_trajectory(map, truth, options);
  std::set<int64_t> times;
  for (const InputFrame& frame : frames) times.insert(frame.utime_us);
  metrics.frames = std::max(images, static_cast<int>(times.size()));
  if (times.empty()) return metrics;

  const double all = metrics.frames;
  for (const TimedPose& pose : map) metrics.tracked_frames += static_cast<int>(times.count(pose.utime_us));
  metrics.tracked_frame_ratio = metrics.tracked_frames / all;

  const int64_t duration_us = *times.rbegin() - *times.begin();
  const int64_t span_us = map.empty() ? 0 : map.back().utime_us - map.front().utime_us;
  if (duration_us > 0) metrics.span_rate = static_cast<double>(span_us) / static_cast<double>(duration_us);

  std::vector<TimedPose> at_frames;
  at_frames.reserve(times.size());
  for (const int64_t utime_us : times) at_frames.push_back({utime_us, SE3()});
  metrics.frames_with_truth = static_cast<int>(associate(at_frames, truth, options).size());
  // If the map has poses but cannot be aligned, it is unknown which frames are true. If it has no poses, none is.
  const bool is_known = metrics.map.truth_from_estimate || map.empty();
  // If the whole truth is not longer than true_distance_m, every pose would count as true.
  const bool tells_anything = extent(truth) > options.true_distance_m;
  if (is_known && tells_anything && metrics.frames_with_truth > 0)
    metrics.true_rate = true_rate_of(metrics, times, options.true_distance_m);

  std::set<int64_t> in_a_submap;
  for (const auto& submap : submaps) {
    for (const TimedPose& pose : submap) {
      if (times.count(pose.utime_us)) in_a_submap.insert(pose.utime_us);
    }
  }
  metrics.submap_frame_ratio = static_cast<double>(in_a_submap.size()) / all;
  return metrics;
}

}  // namespace rumi::tool
