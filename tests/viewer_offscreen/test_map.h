// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <functional>
#include <opencv2/core.hpp>

#include "slam/map/submap.h"
#include "viewer_offscreen/scene/timeline.h"

namespace rumi::viewer_offscreen {

// Returns a submap of a camera that moves along `path` (seconds -> position) and looks away from the origin, with
// landmarks scattered around what it sees. It takes 30 frames a second; every tenth is a keyframe.
inline Submap make_test_submap(int id, double begin_s, double end_s, const std::function<Eigen::Vector3d(double)>& path,
                               int landmarks) {
  Submap submap;
  submap.key = {1, id};
  submap.kind = id < 0 ? SubmapKind::kBack : SubmapKind::kFront;
  submap.camera.width = 640;
  submap.camera.height = 480;
  submap.camera.fx = submap.camera.fy = 525;
  submap.camera.cx = 319.5;
  submap.camera.cy = 239.5;
  submap.revision = 1;
  int reference = kNone;
  const int first = static_cast<int>(std::lround(begin_s * 30)), last = static_cast<int>(std::lround(end_s * 30));
  for (int i = first; i < last; ++i) {
    const Eigen::Vector3d at = path(i / 30.0), z = Eigen::Vector3d(at.x(), at.y(), 0.05).normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d r;
    r << x, z.cross(x), z;
    const SE3 cam_from_submap = SE3(r, at).inverse();
    const int64_t utime_us = 1'000'000 + static_cast<int64_t>(i) * 33'333;
    if ((i - first) % 10 == 0) {
      Keyframe keyframe;
      keyframe.id = ++reference;
      keyframe.utime_us = utime_us;
      keyframe.cam_from_submap = cam_from_submap;
      keyframe.features = std::make_shared<Features>();
      keyframe.revision = keyframe.created_revision = 1;
      submap.keyframes[reference] = keyframe;
    }
    FramePose frame{utime_us, reference, cam_from_submap * submap.keyframes[reference].cam_from_submap.inverse(), 1};
    submap.frames.set(frame);
  }
  cv::RNG rng(static_cast<uint64_t>(id) + 5);
  for (int i = 0; i < landmarks; ++i) {
    Landmark landmark;
    landmark.id = i;
    const Eigen::Vector3d near = path(rng.uniform(begin_s, end_s));
    landmark.position =
        near * rng.uniform(1.2, 2.6) + Eigen::Vector3d(rng.gaussian(0.2), rng.gaussian(0.2), rng.gaussian(0.5));
    landmark.revision = 1;
    submap.landmarks[i] = landmark;
  }
  return submap;
}

inline Eigen::Vector3d test_circle(double t) {
  return {1.5 * std::cos(0.3 * t), 1.2 * std::sin(0.3 * t), 0.08 * std::sin(1.1 * t)};
}

inline std::vector<FrameNote> test_frames(double begin_s, double end_s) {
  std::vector<FrameNote> all;
  for (int i = static_cast<int>(std::lround(begin_s * 30)); i < static_cast<int>(std::lround(end_s * 30)); ++i)
    all.push_back({1'000'000 + static_cast<int64_t>(i) * 33'333, FrameNote::kUnknownState, {}});
  return all;
}

}  // namespace rumi::viewer_offscreen
