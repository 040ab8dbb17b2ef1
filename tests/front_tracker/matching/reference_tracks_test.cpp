// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/matching/reference_tracks.h"

#include <gtest/gtest.h>

#include "tests/front_tracker/feature_scene.h"

namespace rumi::front_tracker {
namespace {

struct Followed {
  int right = 0, wrong = 0;
  double motion_px = 0;
};

Followed follow(const std::function<SE3(int)>& motion, int frames) {
  FeatureScene scene(3);
  std::vector<int> point_at_start, point_now;
  Frame last = scene.frame(0, motion(0), &point_at_start);
  for (Keypoint& k : const_cast<Features&>(*last.features).keypoints) k.octave = 3;
  ReferenceTracks tracks(last.features);
  for (int i = 1; i < frames; ++i) {
    Frame now = scene.frame(i, motion(i), &point_now);
    for (Keypoint& k : const_cast<Features&>(*now.features).keypoints) k.octave = 3;
    tracks.follow(test_camera(), estimate_motion(test_camera(), *last.features, *now.features), now);
    last = now;
  }
  Followed result;
  result.motion_px = tracks.motion_px();
  for (size_t i = 0; i < point_at_start.size(); ++i) {
    const int found = tracks.found().back()[i];
    if (found == kNone) continue;
    const bool right = point_at_start[i] != kNone && point_now[found] == point_at_start[i];
    ++(right ? result.right : result.wrong);
  }
  EXPECT_EQ(tracks.count(), result.right + result.wrong);
  return result;
}

TEST(ReferenceTracks, FollowsAFastTurnAndSeesThatItIsNoMore) {
  // Ten degrees from one frame to the next are 90 pixels.
  const Followed turn = follow([](int i) { return SyntheticScene::pose(0, 0, 0, 0.17 * i); }, 4);
  EXPECT_GT(turn.right, 50);
  EXPECT_LT(turn.wrong, 0.02 * turn.right);
  EXPECT_LT(turn.motion_px, 1.5);
}

TEST(ReferenceTracks, MeasuresMotionBeyondARotation) {
  const Followed walk = follow([](int i) { return SyntheticScene::pose(0.04 * i, 0, 0, -0.01 * i); }, 10);
  EXPECT_GT(walk.right, 200);
  EXPECT_LT(walk.wrong, 0.02 * walk.right);
  EXPECT_GT(walk.motion_px, 3);
}

}  // namespace
}  // namespace rumi::front_tracker
