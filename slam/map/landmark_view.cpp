// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/landmark_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slam/geometry/triangulation.h"
#include "slam/numeric/median.h"

namespace rumi {
namespace {

constexpr size_t kMostDescriptors = 12;  // the newest ones are enough for a median; the cost grows with the square

Descriptor median_descriptor(const std::vector<const Descriptor*>& seen) {
  if (seen.size() < 3) return *seen[0];
  std::array<std::array<int, kMostDescriptors>, kMostDescriptors> distance{};
  for (size_t i = 1; i < seen.size(); ++i)
    for (size_t j = 0; j < i; ++j) distance[i][j] = distance[j][i] = hamming_distance(*seen[i], *seen[j]);
  size_t best = 0;
  int best_median = 1 << 20;
  std::vector<int> row;
  for (size_t i = 0; i < seen.size(); ++i) {
    row.assign(distance[i].begin(), distance[i].begin() + static_cast<std::ptrdiff_t>(seen.size()));
    if (const int middle = median(&row); middle < best_median) {
      best_median = middle;
      best = i;
    }
  }
  return *seen[best];
}

}  // namespace

void update_landmark_view(const Submap& submap, Landmark* landmark) {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  std::vector<const Descriptor*> descriptors;
  double distance = 0;
  const double f = 0.5 * (submap.camera.fx + submap.camera.fy);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  // The newest observations come first: the latest appearances are most like those in the next frames.
  for (auto o = landmark->observations.rbegin(); o != landmark->observations.rend(); ++o) {
    const Keyframe* kf = submap.keyframe(o->keyframe_id);
    if (!kf) continue;
    const Eigen::Vector3d ray = landmark->position - kf->cam_from_submap.center();
    const double d = ray.norm();
    if (!(d > 0)) continue;
    direction += ray / d;
    if (information.isZero())
      information = ray * ray.transpose() / (d * d * d * d);  // a prior along the ray: its standard deviation is the
                                                              // distance
    const double scale = submap.pyramid.scale(kf->features->keypoints[o->keypoint_index].octave);
    information += sight_information(ray, scale / f);
    distance = d * scale;  // the loop ends with the oldest observation, which made the landmark
    if (descriptors.size() < kMostDescriptors) descriptors.push_back(&kf->features->descriptors[o->keypoint_index]);
  }
  if (descriptors.empty()) return;
  landmark->information = information;
  landmark->view_direction = direction.normalized();
  landmark->octave0_distance = distance;
  if (!landmark->is_described) landmark->descriptor = median_descriptor(descriptors);
  landmark->is_described = true;
}

int predict_octave(const Landmark& landmark, double distance, const std::vector<double>& scales) {
  if (scales.size() < 2 || !(distance > 0) || !(landmark.octave0_distance > 0)) return 0;
  const double octave = std::log(landmark.octave0_distance / distance) / std::log(scales[1] / scales[0]);
  return std::clamp(static_cast<int>(std::ceil(octave)), 0, static_cast<int>(scales.size()) - 1);
}

double median_depth(const Submap& submap, const SE3& cam_from_submap, const std::vector<int>& landmark_ids) {
  std::vector<double> depths;
  for (int id : landmark_ids)
    if (const Landmark* lm = id == kNone ? nullptr : submap.landmark(id))
      depths.push_back((cam_from_submap * lm->position).z());
  return depths.empty() ? 1 : median(&depths);
}

}  // namespace rumi
