// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/matching/frame_motion.h"

#include <algorithm>
#include <vector>

#include "slam/features/matching.h"
#include "slam/geometry/rotation_fit.h"

namespace rumi::front_tracker {
namespace {

std::vector<int> coarse_keypoints(const Features& features) {
  constexpr int kCoarse = 3;  // a third of the keypoints have this octave or a higher one: enough for a rotation
  std::vector<int> coarse;
  for (size_t i = 0; i < features.size(); ++i)
    if (features.keypoints[i].octave >= kCoarse) coarse.push_back(static_cast<int>(i));
  return coarse;
}

}  // namespace

FrameMotion estimate_motion(const Camera& camera, const Features& a, const Features& b) {
  constexpr size_t kFewest = 20;
  const double farthest = kFarthestMotion * camera.width, f = 0.5 * (camera.fx + camera.fy);
  const std::vector<int> from = coarse_keypoints(a), to = coarse_keypoints(b);
  std::vector<Eigen::Vector3d> rays_a, rays_b;
  if (!from.empty() && !to.empty())
    for (const Match& m : match_features(a, from, b, to, {})) {
      rays_a.push_back(camera.ray(a.undistorted[m.first]));
      rays_b.push_back(camera.ray(b.undistorted[m.second]));
    }
  if (rays_a.size() < kFewest) return {Eigen::Matrix3d::Identity(), farthest};
  const auto fit = fit_rotation(std::move(rays_a), std::move(rays_b));
  if (!fit) return {Eigen::Matrix3d::Identity(), farthest};
  return {fit->b_from_a, std::min(farthest, 8 + 3 * f * fit->median_residual_rad)};
}

}  // namespace rumi::front_tracker
