// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/honesty.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "slam/geometry/alignment.h"

namespace rumi::tool {
namespace {

struct Quantiles {
  // Errors, in deviations of one coordinate, that a Gaussian does not exceed with probability .683 and .954.
  double one, two;
};
constexpr Quantiles kOneDimension{1, 2};
constexpr Quantiles kThreeDimensions{1.8779, 2.8328};
constexpr size_t kFewestAround = 9;  // poses that an alignment needs
// RMS distance of the aligned poses from their mean / deviation of the pose; else the unit is unknown.
constexpr double kLeastMotion = 5;
// The change of scale is measured by two successive steps only if the log ratio of their lengths has a smaller standard
// deviation than this.
constexpr double kLeastLogLength = 0.1;

class Counter {
 public:
  explicit Counter(Quantiles quantiles) : quantiles_(quantiles) {}
  void add(double error, double variance) {
    const double sigma = std::sqrt(variance);
    ++all_;
    one_ += error <= quantiles_.one * sigma;
    two_ += error <= quantiles_.two * sigma;
  }
  WithinSigmas result() const {
    if (all_ == 0) return {};
    return {all_, static_cast<double>(one_) / all_, static_cast<double>(two_) / all_};
  }

 private:
  Quantiles quantiles_;
  int all_ = 0, one_ = 0, two_ = 0;
};

struct Compared {
  int64_t utime_us = 0;
  SE3 pose, truth;
  double position_variance = 0, rotation_variance = 0, log_scale_variance = 0;
};

double squared(float value) { return static_cast<double>(value) * static_cast<double>(value); }

std::vector<Compared> compare(const std::vector<ToldPose>& submap, const std::vector<TimedPose>& truth,
                              const MetricOptions& options) {
  std::vector<TimedPose> poses;
  poses.reserve(submap.size());
  for (const ToldPose& told : submap) poses.push_back(told.pose);
  std::vector<Compared> compared;
  for (const auto& [e, t] : associate(poses, truth, options)) {
    const PoseSigmas& sigmas = submap[e].sigmas;
    compared.push_back({poses[e].utime_us, poses[e].map_from_cam, truth[t].map_from_cam, squared(sigmas.position),
                        squared(sigmas.rotation_rad), squared(sigmas.log_scale)});
  }
  return compared;
}

// True if the true rotation changes. It does not in a truth that has only positions.
bool turns(const std::vector<Compared>& poses) {
  return std::any_of(poses.begin(), poses.end(), [&](const Compared& p) {
    return p.truth.rotation.angularDistance(poses.front().truth.rotation) > 1e-6;
  });
}

class Comparison {
 public:
  explicit Comparison(const MetricOptions& options) : interval_us_(std::llround(options.rpe_interval_s * 1e6)) {}

  void add(const std::vector<Compared>& poses) {
    if (poses.empty()) return;
    const bool has_rotations = turns(poses);
    size_t begin = 0, end = 0;
    for (size_t i = 0; i < poses.size(); ++i) {
      while (poses[i].utime_us - poses[begin].utime_us > interval_us_) ++begin;
      while (end < poses.size() && poses[end].utime_us - poses[i].utime_us <= interval_us_) ++end;
      // At a low frame rate the interval is extended on both sides, so that there are enough poses.
      const size_t first = std::min(begin, i - std::min(i, kFewestAround / 2));
      const size_t last = std::min(poses.size(), std::max(end, i + kFewestAround / 2 + 1));
      if (last - first < kFewestAround) continue;
      add_position(poses, first, last, i);
      if (has_rotations) add_rotation(poses, first, last, i);
    }
    add_steps(poses);
  }

  Honesty result() const {
    Honesty honesty{position_.result(), rotation_.result(), log_scale_.result(), ""};
    if (!honesty.position.one)
      honesty.reason = "no poses with a deviation and a truth that move enough to be aligned";
    else if (!honesty.rotation.one)
      honesty.reason = "the truth has no rotations";
    else if (!honesty.log_scale.one)
      honesty.reason = "no two steps of the interval whose lengths are known";
    return honesty;
  }

 private:
  void add_position(const std::vector<Compared>& poses, size_t first, size_t last, size_t i) {
    std::vector<Eigen::Vector3d> estimated, actual;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (size_t k = first; k < last; ++k) {
      estimated.push_back(poses[k].pose.translation);
      actual.push_back(poses[k].truth.translation);
      middle += estimated.back();
    }
    const auto n = static_cast<double>(last - first);
    double spread = 0;
    for (const Eigen::Vector3d& p : estimated) spread += (p - middle / n).squaredNorm() / n;
    const std::optional<Sim3> aligned = umeyama(estimated, actual, true);
    if (!aligned || !(aligned->scale > 0) || spread < kLeastMotion * kLeastMotion * poses[i].position_variance) return;
    const double error = (*aligned * poses[i].pose.translation - poses[i].truth.translation).norm() / aligned->scale;
    // The alignment has seven parameters, which make the errors smaller than the deviations say.
    position_.add(error, (1 - 7 / (3 * n)) * poses[i].position_variance);
  }

  void add_rotation(const std::vector<Compared>& poses, size_t first, size_t last, size_t i) {
    const auto estimate_from_truth = [&](size_t k) {
      return poses[k].pose.rotation * poses[k].truth.rotation.conjugate();
    };
    const Eigen::Quaterniond here = estimate_from_truth(i);
    Eigen::Vector3d others = Eigen::Vector3d::Zero();
    const auto n = static_cast<double>(last - first);
    for (size_t k = first; k < last; ++k) {
      const Eigen::AngleAxisd off(estimate_from_truth(k) * here.conjugate());
      others += off.angle() * off.axis() / n;
    }
    rotation_.add(others.norm(), (1 - 1 / n) * poses[i].rotation_variance);
  }

  struct Step {
    size_t end = 0;  // index of the later pose; 0: there is no step
    double log_ratio = 0, variance = 0, log_scale_variance = 0;
  };

  // Returns for each pose the step to the pose one interval later.
  std::vector<Step> steps_of(const std::vector<Compared>& poses) const {
    std::vector<Step> steps(poses.size());
    size_t later = 0;
    for (size_t i = 0; i < poses.size(); ++i) {
      // The later pose may be a millisecond too early: periods such as 33,333 us do not add up to a second.
      while (later < poses.size() && poses[later].utime_us - poses[i].utime_us < interval_us_ - 1000) ++later;
      if (later == poses.size()) break;
      const Compared &a = poses[i], &b = poses[later];
      if (b.utime_us - a.utime_us > 3 * interval_us_ / 2) continue;  // frames are missing
      const double length = (b.pose.translation - a.pose.translation).norm();
      const double true_length = (b.truth.translation - a.truth.translation).norm();
      if (!(length > 0) || !(true_length > 0)) continue;
      steps[i] = {later, std::log(length / true_length),
                  (a.position_variance + b.position_variance) / (length * length),
                  (a.log_scale_variance + b.log_scale_variance) / 2};
    }
    return steps;
  }

  void add_steps(const std::vector<Compared>& poses) {
    const std::vector<Step> steps = steps_of(poses);
    for (const Step& step : steps) {
      if (step.end == 0 || steps[step.end].end == 0) continue;
      const Step& next = steps[step.end];
      const double lengths = step.variance + next.variance;
      if (lengths > kLeastLogLength * kLeastLogLength) continue;
      // The variance may also fall: when the camera returns to a place.
      log_scale_.add(std::abs(next.log_ratio - step.log_ratio),
                     lengths + std::abs(next.log_scale_variance - step.log_scale_variance));
    }
  }

  int64_t interval_us_;
  Counter position_{kThreeDimensions}, rotation_{kThreeDimensions}, log_scale_{kOneDimension};
};

}  // namespace

Honesty evaluate_honesty(const std::vector<std::vector<ToldPose>>& submaps, const std::vector<TimedPose>& truth,
                         const MetricOptions& options) {
  Comparison comparison(options);
  size_t told = 0;
  for (const std::vector<ToldPose>& submap : submaps) {
    comparison.add(compare(submap, truth, options));
    told += submap.size();
  }
  Honesty honesty = comparison.result();
  if (told == 0) honesty.reason = "no deviation of a pose is told: an older run?";
  return honesty;
}

}  // namespace rumi::tool
