// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/frame/established_first.h"

#include <utility>
#include <vector>

#include "slam/optimization/whitened_projection.h"

namespace rumi::front_tracker {
namespace {

constexpr size_t kEstablished = 4;   // keyframes that have seen a landmark
constexpr size_t kEnough = 30;       // established landmarks that are matched
constexpr double kAgreeing = 0.6;    // of them
constexpr double kContradicts = 20;  // chi2: far beyond noise, as their pose has an error, too

bool contradicts(const Camera& camera, const SE3& pose, const PointObservation& o) {
  const Eigen::Vector3d p = pose * o.point;
  if (!(p.z() > 1e-6)) return true;
  return WhitenedProjection(camera, o.pixel, o.sigma_px, o.whitening).error(p).squaredNorm() > kContradicts;
}

}  // namespace

void begin_with_established(const Submap& submap, Frame* frame, SE3* pose, FrameObservations* matched) {
  const auto is_established = [&](size_t i) {
    return submap.landmark(frame->landmark_ids[matched->keypoints[i]])->observations.size() >= kEstablished;
  };
  std::vector<PointObservation> established;
  for (size_t i = 0; i < matched->keypoints.size(); ++i)
    if (is_established(i)) established.push_back(matched->observations[i]);
  if (established.size() < kEnough || established.size() == matched->keypoints.size()) return;
  const PoseResult by_them = optimize_pose(submap.camera, *pose, established);
  if (!by_them.converged || by_them.inliers < kAgreeing * static_cast<double>(established.size())) return;
  *pose = by_them.cam_from_submap;
  FrameObservations agreeing;
  for (size_t i = 0; i < matched->keypoints.size(); ++i) {
    const int keypoint = matched->keypoints[i];
    if (!is_established(i) && contradicts(submap.camera, *pose, matched->observations[i])) {
      frame->landmark_ids[keypoint] = kNone;
      continue;
    }
    agreeing.observations.push_back(matched->observations[i]);
    agreeing.keypoints.push_back(keypoint);
  }
  *matched = std::move(agreeing);
}

}  // namespace rumi::front_tracker
