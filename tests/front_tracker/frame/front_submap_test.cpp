// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/frame/front_submap.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/front_tracker/feature_scene.h"

namespace rumi::front_tracker {
namespace {

// The mask leaves out the left part of the image. Things move to the right in the image.
TEST(FrontSubmap, ForgetsWhatMostKeyframesSawWhereNothingIsTheWorld) {
  FeatureScene scene(1);
  const auto submap =
      scene.submap({SyntheticScene::pose(0, 0, 0), SyntheticScene::pose(-0.2, 0, 0), SyntheticScene::pose(-0.4, 0, 0)});
  cv::Mat pixels(480, 640, CV_8U, cv::Scalar(255));
  pixels.colRange(0, 300).setTo(0);
  struct Sights {
    size_t out = 0, all = 0;
  };
  std::map<int, Sights> sights;
  for (const auto& [id, landmark] : submap->map.landmarks)
    for (const Observation& o : landmark.observations) {
      const float x = submap->map.keyframe(o.keyframe_id)->features->keypoints[o.keypoint_index].pixel.x();
      sights[id].out += x < 299.5F;
      ++sights[id].all;
    }
  const size_t before = submap->map.landmarks.size();
  const size_t forgotten = submap->forget_left_out(ImageMask(pixels));
  size_t kept_though_seen_there = 0;
  for (const auto& [id, s] : sights) {
    const bool is_kept = submap->map.landmark(id) != nullptr;
    EXPECT_EQ(is_kept, 2 * s.out <= s.all) << s.out << " of " << s.all;
    kept_though_seen_there += is_kept && s.out > 0;
  }
  EXPECT_GT(kept_though_seen_there, 0u);
  EXPECT_GT(forgotten, before / 4);
  EXPECT_EQ(submap->map.landmarks.size(), before - forgotten);
  for (const auto& [id, kf] : submap->map.keyframes)
    for (int landmark : kf.landmark_ids)
      EXPECT_TRUE(landmark == kNone || submap->map.landmark(landmark)) << "keyframe " << id << " forgets it, too";
  EXPECT_EQ(submap->forget_left_out(ImageMask(pixels)), 0u);
}

TEST(FrontSubmap, ForgetsNothingWhereAllIsTheWorld) {
  FeatureScene scene(2);
  const auto submap = scene.submap({SyntheticScene::pose(0, 0, 0), SyntheticScene::pose(-0.2, 0, 0)});
  const size_t before = submap->map.landmarks.size();
  EXPECT_EQ(submap->forget_left_out({}), 0u);
  EXPECT_EQ(submap->map.landmarks.size(), before);
}

}  // namespace
}  // namespace rumi::front_tracker
