// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/truth_shift.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text/time_units.h"
#include "slam/geometry/alignment.h"

namespace rumi::tool {
namespace {

// In steps of kStepS: the largest shift, and the step of the coarse search.
constexpr int kFarthest = 1000, kCoarse = 5;
constexpr double kStepS = 0.01;
constexpr double kClearlySmaller = 0.5;      // ATE with the shift / ATE without, at most
constexpr double kNearlyAsGood = 1.5;        // error of a shift outside the minimum / error of the best one; up to this
                                             // the best one is not clear
constexpr double kBasin = 0.75;              // error ratio up to which shifts around the best one belong to its minimum
constexpr double kKeepTruth = 0.7;           // share of the poses with a truth that must still have one after the shift
constexpr int64_t kLongestStepUs = 250'000;  // between two poses of the truth that are interpolated, at most
constexpr size_t kPoses = 400;               // poses that are compared, at most

using Places = std::vector<std::optional<Eigen::Vector3d>>;  // true position of each pose; absent without a truth

std::vector<TimedPose> thinned(const std::vector<TimedPose>& poses) {
  if (poses.size() <= kPoses) return poses;
  std::vector<TimedPose> some;
  for (size_t i = 0; i < kPoses; ++i) some.push_back(poses[i * poses.size() / kPoses]);
  return some;
}

std::optional<Eigen::Vector3d> place_at(const std::vector<TimedPose>& truth, int64_t utime_us) {
  const auto after = std::lower_bound(truth.begin(), truth.end(), utime_us,
                                      [](const TimedPose& pose, int64_t time_us) { return pose.utime_us < time_us; });
  if (after == truth.end()) return std::nullopt;
  if (after->utime_us == utime_us) return after->map_from_cam.translation;
  if (after == truth.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const int64_t step_us = after->utime_us - before->utime_us;
  if (step_us > kLongestStepUs) return std::nullopt;
  const double part = static_cast<double>(utime_us - before->utime_us) / static_cast<double>(step_us);
  return (1 - part) * before->map_from_cam.translation + part * after->map_from_cam.translation;
}

class Search {
 public:
  Search(const std::vector<TimedPose>& estimate, const std::vector<TimedPose>& truth)
      : estimate_(thinned(estimate)), truth_(truth), unshifted_(places_at(0)) {
    counted_ = static_cast<size_t>(
        std::count_if(unshifted_.begin(), unshifted_.end(), [](const auto& p) { return p.has_value(); }));
  }

  // Returns (error with that shift) / (error without), over the poses that have a truth either way. Absent if these are
  // too few or cannot be aligned.
  std::optional<double> ratio(int steps) const {
    const Places places = places_at(steps);
    std::vector<Eigen::Vector3d> estimated, with, without;
    for (size_t i = 0; i < estimate_.size(); ++i) {
      if (!places[i] || !unshifted_[i]) continue;
      estimated.push_back(estimate_[i].map_from_cam.translation);
      with.push_back(*places[i]);
      without.push_back(*unshifted_[i]);
    }
    if (estimated.size() < 10 || static_cast<double>(estimated.size()) < kKeepTruth * static_cast<double>(counted_))
      return std::nullopt;
    const std::optional<double> error = error_of(estimated, with), before = error_of(estimated, without);
    if (!error || !before || *before <= 0) return std::nullopt;
    return *error / *before;
  }

 private:
  Places places_at(int steps) const {
    Places places;
    const auto shift_us = to_us(steps * kStepS);
    for (const TimedPose& pose : estimate_) places.push_back(place_at(truth_, pose.utime_us - shift_us));
    return places;
  }
  static std::optional<double> error_of(const std::vector<Eigen::Vector3d>& estimated,
                                        const std::vector<Eigen::Vector3d>& actual) {
    const std::optional<Sim3> aligned = umeyama(estimated, actual, true);
    if (!aligned) return std::nullopt;
    double sum = 0;
    for (size_t i = 0; i < actual.size(); ++i) sum += (*aligned * estimated[i] - actual[i]).squaredNorm();
    const double error = std::sqrt(sum / static_cast<double>(actual.size()));
    return std::isfinite(error) ? std::optional(error) : std::nullopt;
  }

  std::vector<TimedPose> estimate_;
  const std::vector<TimedPose>& truth_;
  Places unshifted_;
  size_t counted_ = 0;
};

// True if the minimum lies inside the searched range and no other shift is nearly as good.
bool is_clear(const std::map<int, double>& ratios, std::map<int, double>::const_iterator best) {
  auto left = best, right = best;
  while (left != ratios.begin() && left->second <= kBasin) --left;
  while (std::next(right) != ratios.end() && right->second <= kBasin) ++right;
  if (left->second <= kBasin || right->second <= kBasin) return false;
  return std::none_of(ratios.begin(), ratios.end(), [&](const auto& other) {
    const bool is_outside = other.first < left->first || other.first > right->first;
    return is_outside && other.second <= kNearlyAsGood * best->second;
  });
}

}  // namespace

std::vector<TimedPose> shifted(std::vector<TimedPose> truth, double seconds) {
  for (TimedPose& pose : truth) pose.utime_us += to_us(seconds);
  return truth;
}

std::optional<TruthShift> find_truth_shift(const std::vector<TimedPose>& estimate, const std::vector<TimedPose>& truth,
                                           const MetricOptions& options) {
  const TrajectoryMetrics now = evaluate_trajectory(estimate, truth, options);
  if (!now.ate_rmse_m) return std::nullopt;
  const Search search(estimate, truth);
  std::map<int, double> ratios;
  for (int steps = -kFarthest; steps <= kFarthest; steps += kCoarse)
    if (const std::optional<double> ratio = search.ratio(steps)) ratios[steps] = *ratio;
  const auto best =
      std::min_element(ratios.begin(), ratios.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (best == ratios.end() || !is_clear(ratios, best)) return std::nullopt;
  int steps = best->first;
  double smallest = best->second;
  for (int near = best->first - kCoarse; near <= best->first + kCoarse; ++near)
    if (const std::optional<double> ratio = search.ratio(near); ratio && *ratio < smallest)
      smallest = *ratio, steps = near;
  const double seconds = steps * kStepS;
  const TrajectoryMetrics then = evaluate_trajectory(estimate, shifted(truth, seconds), options);
  if (steps == 0 || !then.ate_rmse_m || *then.ate_rmse_m > kClearlySmaller * *now.ate_rmse_m) return std::nullopt;
  if (then.associated < kKeepTruth * now.associated) return std::nullopt;
  return TruthShift{seconds, *then.ate_rmse_m};
}

}  // namespace rumi::tool
