// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/model_agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "slam/geometry/rotation_fit.h"
#include "slam/numeric/consensus.h"
#include "slam/numeric/median.h"

namespace rumi::ruminator {
namespace {

constexpr size_t kMinImages = 6;       // fewer say nothing about the shape
constexpr double kMaxDistance = 0.05;  // between positions, of their median distance from the middle
constexpr double kMaxRotationDeg = 5;  // between rotations
constexpr int kSamples = 300;          // of three images
constexpr int kRefits = 3;             // to all images that agree

struct PosePair {
  int image = 0;
  SE3 cam_from_a, cam_from_b;
  Eigen::Quaterniond b_from_a() const { return cam_from_b.rotation.conjugate() * cam_from_a.rotation; }
};

// Returns the alignment of the chosen poses. The rotation is taken from the poses, because positions on a line would
// leave it open.
template <class Indices>
std::optional<Sim3> align(const std::vector<PosePair>& poses, const Indices& chosen) {
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero(), mean_b = Eigen::Vector3d::Zero();
  for (const int i : chosen) {
    mean_a += poses[i].cam_from_a.center() / static_cast<double>(chosen.size());
    mean_b += poses[i].cam_from_b.center() / static_cast<double>(chosen.size());
  }
  double square_a = 0, square_b = 0;
  std::vector<Eigen::Quaterniond> rotations;
  for (const int i : chosen) {
    square_a += (poses[i].cam_from_a.center() - mean_a).squaredNorm();
    square_b += (poses[i].cam_from_b.center() - mean_b).squaredNorm();
    rotations.push_back(poses[i].b_from_a());
  }
  if (!(square_a > 0) || !(square_b > 0)) return std::nullopt;
  const double scale = std::sqrt(square_b / square_a);
  const Eigen::Quaterniond rotation = central_rotation(rotations);
  return Sim3(scale, rotation, mean_b - scale * (rotation * mean_a));
}

// Returns the median distance of b's positions from their median.
double extent(const std::vector<PosePair>& poses) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(poses.size());
    for (const PosePair& p : poses) values.push_back(p.cam_from_b.center()[axis]);
    middle[axis] = median(&values);
  }
  std::vector<double> distances;
  distances.reserve(poses.size());
  for (const PosePair& p : poses) distances.push_back((p.cam_from_b.center() - middle).norm());
  return median(&distances);
}

}  // namespace

std::set<int> agreeing_images(const SparseModel& a, const SparseModel& b) {
  std::vector<PosePair> poses;
  for (const auto& [image, cam_from_a] : a.cam_from_world)
    if (const auto found = b.cam_from_world.find(image); found != b.cam_from_world.end())
      poses.push_back({image, cam_from_a, found->second});
  if (poses.size() < kMinImages) return {};

  const double max_distance = kMaxDistance * extent(poses);
  const auto agreeing = [&](const Sim3& b_from_a) {
    std::vector<int> members;
    for (size_t i = 0; i < poses.size(); ++i) {
      const double distance = (b_from_a * poses[i].cam_from_a.center() - poses[i].cam_from_b.center()).norm();
      const double angle_deg = poses[i].b_from_a().angularDistance(b_from_a.rotation) * 180 / std::numbers::pi;
      if (distance <= max_distance && angle_deg <= kMaxRotationDeg) members.push_back(static_cast<int>(i));
    }
    return members;
  };
  const auto found = find_consensus_of_three(
      poses.size(), {.samples = kSamples}, [&](const std::array<int, 3>& three) { return align(poses, three); },
      agreeing);
  std::vector<int> members = found ? found->members : std::vector<int>();
  for (int i = 0; i < kRefits && members.size() >= 3; ++i)
    if (const std::optional<Sim3> refined = align(poses, members)) members = agreeing(*refined);
  if (members.size() < kMinImages || 2 * members.size() < poses.size()) return {};
  std::set<int> images;
  for (const int i : members) images.insert(poses[i].image);
  return images;
}

}  // namespace rumi::ruminator
