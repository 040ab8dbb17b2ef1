// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/pose_by_corners.h"

#include <gtest/gtest.h>

#include "front_tracker/frame/certainty.h"
#include "tests/front_tracker/feature_scene.h"

namespace rumi::front_tracker {
namespace {

// A submap at its true poses, and a last frame in it.
class PoseByCornersTest : public ::testing::Test {
 protected:
  PoseByCornersTest() {
    const std::vector<SE3> poses = {SyntheticScene::pose(-0.2, 0, 0), SE3(), SyntheticScene::pose(0.2, 0, 0)};
    submap_ = scene_.submap(poses);
    Frame last = scene_.frame(400'000, poses[1]);
    last.cam_from_submap = poses[1];
    last.reference_keyframe = 1;
    last.features = submap_->map.keyframe(1)->features;
    last.landmark_ids = submap_->map.keyframe(1)->landmark_ids;
    motion_.begin_at(std::move(last));
  }
  FoundPose find(Frame frame, const TrackingOptions& options = {}) {
    PatchTemplates templates;
    return PoseByCorners(options).find(*submap_, motion_, std::move(frame), &templates);
  }

  FeatureScene scene_{7};
  std::unique_ptr<FrontSubmap> submap_;
  MotionModel motion_;
};

TEST_F(PoseByCornersTest, NearTheLastFrame) {
  const SE3 truth = SyntheticScene::pose(0.05, 0, 0.02);
  const FoundPose pose = find(scene_.frame(500'000, truth));
  ASSERT_TRUE(pose.found()) << pose.why_not;
  EXPECT_LT((pose.frame.cam_from_submap.center() - truth.center()).norm(), 0.005);
  EXPECT_GT(pose.frame.matches(), 300);
  EXPECT_GE(static_cast<int>(pose.visible.size()), pose.frame.matches());
  EXPECT_TRUE(pose.frame.is_believable);
  EXPECT_GT(pose.motion.value(), 0.005);
}

// The landmarks are far from where the motion model expects them.
TEST_F(PoseByCornersTest, WhereverItsLandmarksAre) {
  const SE3 truth = SyntheticScene::pose(0.1, 0, 0, 0.2);
  const FoundPose pose = find(scene_.frame(500'000, truth));
  ASSERT_TRUE(pose.found()) << pose.why_not;
  EXPECT_LT(rotation_error_deg(pose.frame.cam_from_submap, truth), 0.1);
}

TEST_F(PoseByCornersTest, HangsOnTheKeyframeThatSharesMost) {
  const SE3 truth = SyntheticScene::pose(0.2, 0, 0);
  for (size_t i = 0; i < submap_->map.keyframe(1)->landmark_ids.size(); i += 2)
    if (const int id = submap_->map.keyframe(1)->landmark_ids[i]; id != kNone) submap_->map.remove_observation(id, 1);
  const FoundPose pose = find(scene_.frame(500'000, truth));
  ASSERT_TRUE(pose.found()) << pose.why_not;
  EXPECT_NE(pose.frame.reference_keyframe, 1);
}

TEST_F(PoseByCornersTest, NoneOfAnotherWorld) {
  FeatureScene elsewhere(8);
  const FoundPose pose = find(elsewhere.frame(500'000, SE3()));
  EXPECT_EQ(pose.why_not, "too few landmarks agree");
  EXPECT_FALSE(pose.motion);
}

TEST_F(PoseByCornersTest, NoneThatIsUncertain) {
  TrackingOptions options;
  options.uncertain_px = 1e-4;
  const FoundPose pose = find(scene_.frame(500'000, SyntheticScene::pose(0.05, 0, 0)), options);
  EXPECT_NE(pose.why_not.find("leave the pose uncertain by"), std::string::npos) << pose.why_not;
}

}  // namespace
}  // namespace rumi::front_tracker
