// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/motion_model.h"

#include <algorithm>

#include "slam/numeric/median.h"

namespace rumi::front_tracker {

void MotionModel::go_on(Frame frame) {
  this_cam_from_last_cam_ = frame.cam_from_submap * last_.cam_from_submap.inverse();
  interval_us_ = frame.utime_us - last_.utime_us;
  last_ = std::move(frame);
}

void MotionModel::begin_at(Frame frame) {
  this_cam_from_last_cam_ = SE3();
  interval_us_ = 0;
  last_ = std::move(frame);
}

void MotionModel::follow_mapping(const Submap& map) {
  const Keyframe* reference = map.keyframe(last_.reference_keyframe);
  if (!reference) {
    // The keyframe has been culled: its frames refer to another one now.
    const FramePose* pose = map.frame(last_.utime_us);
    last_.reference_keyframe = pose->reference_keyframe;
    last_.cam_from_keyframe = pose->cam_from_keyframe;
    reference = map.keyframe(last_.reference_keyframe);
  }
  last_.cam_from_submap = last_.cam_from_keyframe * reference->cam_from_submap;
}

SE3 MotionModel::predict(int64_t utime_us) const {
  constexpr double kLongest = 3;  // the motion goes on for at most so many times the last interval
  const int64_t dt_us = utime_us - last_.utime_us;
  if (!is_known() || dt_us == interval_us_) return this_cam_from_last_cam_ * last_.cam_from_submap;
  const double ratio = std::min(kLongest, static_cast<double>(dt_us) / static_cast<double>(interval_us_));
  return SE3::exp(ratio * this_cam_from_last_cam_.log()) * last_.cam_from_submap;
}

double MotionModel::image_motion(const Submap& map, const Frame& frame) const {
  std::vector<double> motion_px;
  for (size_t i = 0; i < frame.landmark_ids.size(); ++i) {
    const Landmark* lm = frame.landmark_ids[i] == kNone ? nullptr : map.landmark(frame.landmark_ids[i]);
    const Eigen::Vector3d before = lm ? last_.cam_from_submap * lm->position : Eigen::Vector3d::Zero();
    if (before.z() > 0)
      motion_px.push_back(
          (map.camera.project_undistorted(before) - frame.features->undistorted[i].cast<double>()).norm());
  }
  return motion_px.empty() ? 0 : median(&motion_px) / map.camera.width;
}

}  // namespace rumi::front_tracker
