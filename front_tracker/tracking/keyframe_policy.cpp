// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/keyframe_policy.h"

#include <algorithm>

namespace rumi::front_tracker {
namespace {

// For this long after it was found again, the camera sees known things from new places, and new things beside them.
constexpr int64_t kFoundAgain_us = 1'000'000;

// Returns how many of the keyframe's landmarks at least three keyframes observe. In a young submap none is observed so
// often yet, so all are counted.
int established_landmarks(const Submap& map, const Keyframe& keyframe) {
  constexpr size_t kYoung = 4, kSeenBy = 3;  // numbers of keyframes
  return static_cast<int>(std::count_if(keyframe.landmark_ids.begin(), keyframe.landmark_ids.end(), [&](int id) {
    const Landmark* lm = id == kNone ? nullptr : map.landmark(id);
    return lm && (lm->observations.size() >= kSeenBy || map.keyframes.size() < kYoung);
  }));
}

}  // namespace

bool KeyframePolicy::is_due(const Submap& map, const Frame& frame, double motion) const {
  if (!frame.is_believable || frame.corners == Corners::kNone) return false;
  const Keyframe& reference = *map.keyframe(frame.reference_keyframe);
  const int established = established_landmarks(map, reference), inliers = frame.matches();
  // In a fast turn, or at a low frame rate, the next frame may be too late.
  if (inliers < options_.urgent_tracked_ratio * established) return true;
  const double since_s = 1e-6 * static_cast<double>(frame.utime_us - last_keyframe_us_);
  if (since_s < options_.min_interval_s) return false;
  if (frame.utime_us - found_again_us_ < kFoundAgain_us) return true;
  // The first image that blurs or darkens becomes a keyframe: the next ones are matched with its corners.
  if (frame.corners == Corners::kFew && static_cast<int>(reference.features->size()) >= keypoints_ / 2) return true;
  if (inliers < options_.min_tracked_ratio * established || motion > options_.max_motion) return true;
  if (inliers < options_.min_inliers && since_s >= 3 * options_.min_interval_s) return true;
  return since_s >= options_.max_interval_s;
}

}  // namespace rumi::front_tracker
