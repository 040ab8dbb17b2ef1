// SPDX-License-Identifier: BSD-3-Clause
// Frames and a submap of the rendered walk, at their true poses.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "slam/features/matching.h"
#include "slam/features/orb_extractor.h"
#include "slam/geometry/triangulation.h"
#include "slam/map/landmark_view.h"
#include "slam/numeric/median.h"
#include "tests/front_tracker/rendered_walk.h"

namespace rumi::testing {
using namespace rumi::front_tracker;

inline const RenderedWalk& walk() { return rendered_walk(); }

inline Frame frame_of(size_t i) {
  OrbExtractor extractor({});
  const auto images = std::make_shared<const ImagePyramid>(extractor.pyramid(walk().images[i]));
  Frame frame = make_frame(walk().utime_us[i], extractor.extract(*images), walk().camera);
  frame.images = images;
  frame.cam_from_submap = walk().cam_from_room[i];
  return frame;
}

// Returns a submap with keyframes at their true poses, and with landmarks that the first two have in common.
inline std::unique_ptr<FrontSubmap> submap_of(const std::vector<size_t>& images) {
  auto s = std::make_unique<FrontSubmap>();
  s->map.camera = walk().camera;
  s->map.revision = 1;
  s->octave_scales = s->map.pyramid.scales();
  for (size_t i : images) {
    Frame frame = frame_of(i);
    s->add_keyframe(&frame);
  }
  const Keyframe &a = *s->map.keyframe(0), &b = *s->map.keyframe(1);
  for (const Match& m : match_features(*a.features, {}, *b.features, {}, {})) {
    const auto ray = [](const Keyframe& kf, int i) { return walk().camera.ray(kf.features->undistorted[i]); };
    const auto point = triangulate(a.cam_from_submap, ray(a, m.first), b.cam_from_submap, ray(b, m.second));
    if (!point) continue;
    const int id = s->add_landmark(*point).id;
    s->map.add_observation(id, 0, m.first);
    s->map.add_observation(id, 1, m.second);
    update_landmark_view(s->map, s->map.landmark(id));
  }
  return s;
}

// Returns the median distance, in pixels, between the landmarks' projections at the frame's pose and at the true one.
inline double median_shift(const FrontSubmap& s, const Frame& frame, const SE3& cam_from_room) {
  std::vector<double> shifts;
  for (int id : frame.landmark_ids) {
    if (id == kNone) continue;
    const Eigen::Vector3d& p = s.map.landmark(id)->position;
    shifts.push_back((walk().camera.project_undistorted(cam_from_room * p) -
                      walk().camera.project_undistorted(frame.cam_from_submap * p))
                         .norm());
  }
  return median(&shifts);
}

inline void expect_consistent(const Frame& frame) {
  const size_t n = frame.features->size();
  EXPECT_EQ(frame.landmark_ids.size(), n);
  EXPECT_EQ(frame.features->descriptors.size(), n);
  EXPECT_EQ(frame.features->undistorted.size(), n);
  EXPECT_EQ(frame.features->whitenings.size(), n);
}

}  // namespace rumi::testing
