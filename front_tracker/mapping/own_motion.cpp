// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/mapping/own_motion.h"

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include "slam/features/descriptor.h"

namespace rumi::front_tracker {
namespace {

constexpr int kAsked = 4;           // keyframes
constexpr float kReach = 0.08F;     // of the image's width, from where it was seen
constexpr int kSame = 50;           // Hamming distance of what may be the point at its projection
constexpr int kTwin = 40;           // of what is certainly the same thing ...
constexpr double kMaxRatio = 0.8;   // ... and of it beside anything else nearby
constexpr float kAtProjection = 4;  // standard deviations

enum class Sight { kNothing, kThere, kElsewhere };

// A keyframe that is asked, and what it is asked for.
struct Question {
  const Camera& camera;
  const Keyframe& other;
  const KeypointGrid& grid;
  const Descriptor& descriptor;
  int octave;
  float sigma_px;

  int distance_to(int keypoint) const { return hamming_distance(descriptor, other.features->descriptors[keypoint]); }
};

bool is_there(const Question& q, const Eigen::Vector3d& point) {
  const Eigen::Vector3d at = q.other.cam_from_submap * point;
  if (!(at.z() > 1e-6)) return false;
  const Eigen::Vector2f predicted = q.camera.project_undistorted(at).cast<float>();
  if (!q.camera.contains(predicted.cast<double>())) return false;
  const float near = kAtProjection * q.sigma_px;
  bool found = false;
  q.grid.for_each_near(predicted, near, [&](int i) {
    found = found || ((q.other.features->undistorted[i] - predicted).norm() <= near && q.distance_to(i) <= kSame);
  });
  return found;
}

// One keypoint looks like it, and no other but those of the same corner in another level.
bool has_twin(const Question& q, const Eigen::Vector2f& seen) {
  const Features& features = *q.other.features;
  const float reach = kReach * static_cast<float>(q.camera.width);
  std::vector<std::pair<int, int>> alike;  // distance, keypoint
  q.grid.for_each_near(seen, reach, [&](int i) {
    if (std::abs(features.keypoints[i].octave - q.octave) > 1 || (features.undistorted[i] - seen).norm() > reach)
      return;
    if (const int distance = q.distance_to(i); distance * kMaxRatio <= kTwin) alike.emplace_back(distance, i);
  });
  const auto best = std::min_element(alike.begin(), alike.end());
  if (best == alike.end() || best->first > kTwin) return false;
  return std::none_of(alike.begin(), alike.end(), [&](const std::pair<int, int>& one) {
    const float apart = (features.undistorted[one.second] - features.undistorted[best->second]).norm();
    return apart > kAtProjection * q.sigma_px && one.first * kMaxRatio < best->first;
  });
}

Sight look(const FrontSubmap& submap, const Eigen::Vector3d& point, const Twin& twin, const Keyframe& other) {
  const auto grid = submap.grids.find(other.id);
  if (grid == submap.grids.end()) return Sight::kNothing;
  const Features& features = *twin.keyframe.features;
  const int octave = features.keypoints[twin.keypoint].octave;
  const Question question{submap.map.camera,
                          other,
                          grid->second,
                          features.descriptors[twin.keypoint],
                          octave,
                          static_cast<float>(submap.octave_scales[octave])};
  if (is_there(question, point)) return Sight::kThere;
  return has_twin(question, features.undistorted[twin.keypoint]) ? Sight::kElsewhere : Sight::kNothing;
}

}  // namespace

bool is_seen_elsewhere(const FrontSubmap& submap, const Eigen::Vector3d& point, const Twin& a, const Twin& b) {
  int there = 0, elsewhere = 0, asked = 0;
  for (auto it = submap.map.keyframes.rbegin(); it != submap.map.keyframes.rend() && asked < kAsked; ++it) {
    const Keyframe& other = it->second;
    if (other.id == a.keyframe.id || other.id == b.keyframe.id) continue;
    ++asked;
    const bool nearer_to_a =
        std::abs(other.utime_us - a.keyframe.utime_us) <= std::abs(other.utime_us - b.keyframe.utime_us);
    const Sight sight = look(submap, point, nearer_to_a ? a : b, other);
    there += sight == Sight::kThere;
    elsewhere += sight == Sight::kElsewhere;
  }
  return elsewhere > there;
}

}  // namespace rumi::front_tracker
