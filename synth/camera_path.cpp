// SPDX-License-Identifier: BSD-3-Clause
#include "synth/camera_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "synth/handheld.h"

namespace rumi::synth {
namespace {

bool parse_pose(const std::string& line, double* time_s, SE3* pose) {
  std::istringstream in(line);
  double v[8];
  for (double& value : v)
    if (!(in >> value) || !std::isfinite(value)) return false;
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  if (std::abs(q.norm() - 1) > 0.01) return false;
  *time_s = v[0];
  *pose = SE3(q, Eigen::Vector3d(v[1], v[2], v[3]));
  return true;
}

}  // namespace

Result<CameraPath> CameraPath::load(const std::string& file) {
  std::ifstream in(file);
  if (!in) return Error{"cannot be opened", file, "give a TUM trajectory file"};
  CameraPath path;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    double time_s = 0;
    SE3 pose;
    const auto where = [&] { return fmt::format("{}:{}", file, number); };
    if (!parse_pose(line, &time_s, &pose))
      return Error{fmt::format("'{}' is not a pose", line.substr(0, 80)), where(), "expected: t tx ty tz qx qy qz qw"};
    if (!path.times_s_.empty() && time_s <= path.times_s_.back())
      return Error{fmt::format("time {} does not rise", time_s), where(), "sort the file"};
    path.times_s_.push_back(time_s);
    path.poses_.push_back(pose);
  }
  if (path.poses_.size() < 2) return Error{"fewer than two poses", file};
  return path;
}

CameraPath CameraPath::walk(double seconds, uint64_t seed) {
  constexpr double kLoopSeconds = 22, kSampleHz = 100;
  constexpr double kWalkStart_s = 1000;  // not 0, because a time of 0 often means that there is no time
  const double loops = seconds >= 16 ? std::max(1.0, std::round(seconds / kLoopSeconds)) : seconds / kLoopSeconds;
  const double base_hz = loops / seconds;
  cv::RNG rng(seed * 7919 + 17);
  const auto slow = [&] { return Wobble(rng, {base_hz, 2 * base_hz, 3 * base_hz}); };
  const auto fast = [&] { return Wobble(rng, {1.1, 1.9, 3.3}); };
  const Wobble radius = slow(), height = slow(), gaze = slow(), tilt = slow();
  const Wobble shake_x = fast(), shake_y = fast(), shake_z = fast(), nod = fast(), shake_yaw = fast(), roll = fast();
  CameraPath path;
  const int samples = static_cast<int>(std::ceil(seconds * kSampleHz)) + 1;
  for (int i = 0; i < samples; ++i) {
    const double t = i / kSampleHz;
    const double angle = 2 * M_PI * base_hz * t;
    // At both ends the walk keeps to its loop and the camera looks straight outwards, so that the walk begins with pure
    // sideways motion.
    const double free = std::min(1.0, 4 * std::pow(std::sin(M_PI * t / seconds), 2));
    const double r = 1.25 + 0.25 * free * radius.at(t);
    const Eigen::Vector3d position(r * std::cos(angle) + 0.008 * shake_x.at(t),
                                   0.85 * r * std::sin(angle) + 0.008 * shake_y.at(t),
                                   1.45 + 0.18 * height.at(t) + 0.01 * shake_z.at(t));
    const double yaw = angle + 0.55 * free * gaze.at(t) + 0.008 * shake_yaw.at(t);
    const double pitch = -0.10 + 0.22 * tilt.at(t) + 0.008 * nod.at(t);
    path.times_s_.push_back(kWalkStart_s + t);
    path.poses_.push_back(look(position, yaw, pitch, 0.02 * roll.at(t)));
  }
  return path;
}

void CameraPath::add(double time_s, const SE3& map_from_cam) {
  times_s_.push_back(time_s);
  poses_.push_back(map_from_cam);
}

SE3 CameraPath::at(double time_s) const {
  if (time_s <= times_s_.front()) return poses_.front();
  if (time_s >= times_s_.back()) return poses_.back();
  const size_t i = std::upper_bound(times_s_.begin(), times_s_.end(), time_s) - times_s_.begin() - 1;
  const double step = times_s_[i + 1] - times_s_[i];
  const double u = (time_s - times_s_[i]) / step;
  // Cubic Hermite interpolation: a camera has mass, so its velocity must not jump from sample to sample.
  const auto velocity = [&](size_t k) -> Eigen::Vector3d {
    const size_t a = k > 0 ? k - 1 : k, b = std::min(k + 1, times_s_.size() - 1);
    return (poses_[b].translation - poses_[a].translation) / (times_s_[b] - times_s_[a]);
  };
  const double u2 = u * u, u3 = u2 * u;
  const Eigen::Vector3d position = (2 * u3 - 3 * u2 + 1) * poses_[i].translation +
                                   (u3 - 2 * u2 + u) * step * velocity(i) +
                                   (3 * u2 - 2 * u3) * poses_[i + 1].translation + (u3 - u2) * step * velocity(i + 1);
  return SE3(poses_[i].rotation.slerp(u, poses_[i + 1].rotation), position);
}

Eigen::Vector3d CameraPath::up() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SE3& pose : poses_) sum -= pose.rotation * Eigen::Vector3d::UnitY();
  if (sum.norm() < 1e-6 * static_cast<double>(poses_.size())) return Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d mean = sum.normalized();
  // A camera that always looks down to one side tilts the mean. Trajectories nearly always have gravity along an axis
  // of their map, so an axis within 30 degrees of the mean is returned instead.
  int axis = 0;
  mean.cwiseAbs().maxCoeff(&axis);
  if (std::abs(mean[axis]) < std::cos(30 * M_PI / 180)) return mean;
  return std::copysign(1.0, mean[axis]) * Eigen::Vector3d::Unit(axis);
}

CameraPath CameraPath::cut(double begin_s, double end_s) const {
  CameraPath path;
  for (size_t i = 0; i < times_s_.size(); ++i) {
    if (times_s_[i] < begin_s || times_s_[i] > end_s) continue;
    path.times_s_.push_back(times_s_[i]);
    path.poses_.push_back(poses_[i]);
  }
  return path;
}

}  // namespace rumi::synth
