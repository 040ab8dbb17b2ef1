// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/frame/frame.h"

#include <algorithm>

#include "front_tracker/frame/weigh_by_area.h"

namespace rumi::front_tracker {

int Frame::matches() const {
  return static_cast<int>(std::count_if(landmark_ids.begin(), landmark_ids.end(), [](int id) { return id != kNone; }));
}

void Frame::clear_matches() { std::fill(landmark_ids.begin(), landmark_ids.end(), kNone); }

Frame make_frame(int64_t utime_us, Features features, const Camera& camera) {
  features.undistort(camera);
  Frame frame;
  frame.utime_us = utime_us;
  frame.grid = KeypointGrid(features.undistorted, camera);
  frame.landmark_ids.assign(features.size(), kNone);
  frame.features = std::make_shared<const Features>(std::move(features));
  return frame;
}

FrameObservations observations_of(const Frame& frame, const Submap& submap, const std::vector<double>& octave_scales) {
  FrameObservations out;
  for (size_t i = 0; i < frame.landmark_ids.size(); ++i) {
    const Landmark* lm = frame.landmark_ids[i] == kNone ? nullptr : submap.landmark(frame.landmark_ids[i]);
    if (!lm) continue;
    out.observations.push_back({lm->position, frame.features->undistorted[i].cast<double>(),
                                octave_scales[frame.features->keypoints[i].octave], frame.features->whitening(i)});
    out.keypoints.push_back(static_cast<int>(i));
  }
  return out;
}

int refine_pose(const Camera& camera, const Submap& submap, const std::vector<double>& octave_scales, Frame* frame,
                Weights weights, const std::vector<EpipolarView>& views) {
  FrameObservations matched = observations_of(*frame, submap, octave_scales);
  if (weights == Weights::kByArea) weigh_by_area(camera, &matched.observations);
  const PoseResult result = optimize_pose(camera, frame->cam_from_submap, matched.observations, {}, views);
  if (!result.converged) return 0;
  frame->cam_from_submap = result.cam_from_submap;
  for (size_t i = 0; i < matched.keypoints.size(); ++i)
    if (!result.inlier[i]) frame->landmark_ids[matched.keypoints[i]] = kNone;
  return result.inliers;
}

}  // namespace rumi::front_tracker
