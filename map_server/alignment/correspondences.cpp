// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/alignment/correspondences.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "slam/features/keypoint_grid.h"
#include "slam/numeric/median.h"

namespace rumi::map_server {
namespace {

std::map<int64_t, int> keyframes_by_time(const Submap& submap) {
  std::map<int64_t, int> by_time;
  for (const auto& [id, keyframe] : submap.keyframes) by_time[keyframe.utime_us] = id;
  return by_time;
}

// The keypoints of a keyframe that observe a landmark: their pixels, and their indices in the keyframe.
struct Observed {
  std::vector<Eigen::Vector2f> pixels;
  std::vector<int> keypoints;

  explicit Observed(const Keyframe& keyframe) {
    for (size_t i = 0; i < keyframe.landmark_ids.size(); ++i) {
      if (keyframe.landmark_ids[i] == kNone) continue;
      pixels.push_back(keyframe.features->undistorted[i]);
      keypoints.push_back(static_cast<int>(i));
    }
  }

  // Returns the index of the nearest pixel within the distance, or kNone if there is no such pixel.
  int nearest(const KeypointGrid& grid, const Eigen::Vector2f& pixel, float max_distance_px) const {
    int best = kNone;
    float best_distance = max_distance_px;
    grid.for_each_near(pixel, max_distance_px, [&](int i) {
      const float distance = (pixels[i] - pixel).norm();
      if (distance < best_distance || (distance == best_distance && best == kNone)) {
        best = i;
        best_distance = distance;
      }
    });
    return best;
  }
};

// Appends the matches between two keyframes of one image: keypoints with the same index if both have the same corners,
// otherwise keypoints that are each other's nearest.
void match_keyframes(const Keyframe& a, const Keyframe& b, const Camera& camera, float max_distance_px, int shared,
                     std::vector<LandmarkMatch>* matches) {
  if (same_corners(*a.features, *b.features)) {
    for (size_t i = 0; i < a.landmark_ids.size(); ++i)
      if (a.landmark_ids[i] != kNone && b.landmark_ids[i] != kNone)
        matches->push_back({a.landmark_ids[i], b.landmark_ids[i], shared, static_cast<int>(i), static_cast<int>(i)});
    return;
  }
  const Observed in_a(a), in_b(b);
  const KeypointGrid grid_a(in_a.pixels, camera), grid_b(in_b.pixels, camera);
  for (size_t i = 0; i < in_a.pixels.size(); ++i) {
    const int j = in_b.nearest(grid_b, in_a.pixels[i], max_distance_px);
    if (j == kNone || in_a.nearest(grid_a, in_b.pixels[j], max_distance_px) != static_cast<int>(i)) continue;
    const int keypoint_a = in_a.keypoints[i], keypoint_b = in_b.keypoints[j];
    matches->push_back({a.landmark_ids[keypoint_a], b.landmark_ids[keypoint_b], shared, keypoint_a, keypoint_b});
  }
}

}  // namespace

bool same_corners(const Features& a, const Features& b) {
  return a.descriptors == b.descriptors &&
         std::equal(a.keypoints.begin(), a.keypoints.end(), b.keypoints.begin(), b.keypoints.end(),
                    [](const Keypoint& x, const Keypoint& y) { return x.octave == y.octave; });
}

std::vector<SharedKeyframe> shared_keyframes(const Submap& a, const Submap& b) {
  std::vector<SharedKeyframe> shared;
  const std::map<int64_t, int> of_b = keyframes_by_time(b);
  for (const auto& [utime_us, id] : keyframes_by_time(a))
    if (const auto other = of_b.find(utime_us); other != of_b.end()) shared.push_back({utime_us, id, other->second});
  return shared;
}

Correspondences find_correspondences(const Submap& a, const Submap& b, double max_distance_px) {
  Correspondences common;
  if (a.stream != b.stream) return common;
  for (const auto& [utime_us, frame] : a.frames)
    if (b.frames.contains(utime_us)) common.frames.push_back(utime_us);
  if (common.frames.empty()) return common;
  common.keyframes = shared_keyframes(a, b);
  for (size_t i = 0; i < common.keyframes.size(); ++i)
    match_keyframes(*a.keyframe(common.keyframes[i].a), *b.keyframe(common.keyframes[i].b), a.camera,
                    static_cast<float>(max_distance_px), static_cast<int>(i), &common.landmarks);
  return common;
}

ScaleRatio scale_ratio(const Submap& a, const Submap& b, const Correspondences& common, int shared, int min_landmarks) {
  const SE3& cam_from_a = a.keyframe(common.keyframes[shared].a)->cam_from_submap;
  const SE3& cam_from_b = b.keyframe(common.keyframes[shared].b)->cam_from_submap;
  std::vector<double> logs, depths;
  for (const LandmarkMatch& match : common.landmarks) {
    if (match.shared != shared) continue;
    const double depth_a = (cam_from_a * a.landmark(match.a)->position).z();
    const double depth_b = (cam_from_b * b.landmark(match.b)->position).z();
    if (!(depth_a > 0 && depth_b > 0)) continue;
    logs.push_back(std::log(depth_b / depth_a));
    depths.push_back(depth_b);
  }
  if (static_cast<int>(logs.size()) < std::max(1, min_landmarks))
    return {0, std::numeric_limits<double>::infinity(), 0};
  const RobustMean ratio = robust_mean(&logs, static_cast<double>(logs.size()));
  return {ratio.value, ratio.sigma, median(&depths)};
}

}  // namespace rumi::map_server
