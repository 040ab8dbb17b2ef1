// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/pose_by_patches.h"

#include <gtest/gtest.h>

#include "tests/front_tracker/walk_submap.h"

namespace rumi::front_tracker {
namespace {

using testing::walk;

constexpr size_t kLast = 32;
constexpr double kMaxMotion = 0.2;

// The tracker's state after its last frame, which is a keyframe of a submap at true poses.
class PoseByPatchesTest : public ::testing::Test {
 protected:
  PoseByPatchesTest() { track_up_to_last(Corners::kEnough); }
  void track_up_to_last(Corners corners) {
    Frame before;
    before.utime_us = walk().utime_us[kLast - 1];
    before.cam_from_submap = walk().cam_from_room[kLast - 1];
    motion_.begin_at(before);
    Frame last = testing::frame_of(kLast);
    last.landmark_ids = submap_->map.keyframe(1)->landmark_ids;
    last.reference_keyframe = 1;
    last.corners = corners;
    motion_.go_on(last);
    by_patches_.note({.frame = last});
  }
  FoundPose find(size_t image) {
    const auto images = std::make_shared<const ImagePyramid>(OrbExtractor({}).pyramid(walk().images[image]));
    return by_patches_.find(*submap_, motion_, next_us_, images, &templates_);
  }

  std::unique_ptr<FrontSubmap> submap_ = testing::submap_of({20, kLast});
  MotionModel motion_;
  TrackingOptions options_{.patch_motion = 0.1};  // the walk has only twenty images a second
  PoseByPatches by_patches_{options_, kMaxMotion};
  PatchTemplates templates_;
  int64_t next_us_ = walk().utime_us[kLast + 1];
};

TEST_F(PoseByPatchesTest, OfAnImageThatHardlyDiffersFromTheLast) {
  ASSERT_TRUE(by_patches_.may_do(motion_, next_us_));
  const FoundPose pose = find(kLast + 1);
  ASSERT_TRUE(pose.found()) << pose.why_not;
  EXPECT_LT(testing::median_shift(*submap_, pose.frame, walk().cam_from_room[kLast + 1]), 0.5) << "px";
  EXPECT_EQ(pose.frame.corners, Corners::kNone);
  EXPECT_GT(pose.motion.value(), 0);
}

TEST_F(PoseByPatchesTest, NoneOfAnImageOfElsewhere) {
  EXPECT_FALSE(find(100).found());
  submap_->keep_images(0);
  EXPECT_EQ(find(kLast + 1).why_not, "no keyframe has an image");
}

TEST_F(PoseByPatchesTest, NotInFastMotion) {
  options_.patch_motion = 0.01;
  by_patches_ = PoseByPatches(options_, kMaxMotion);
  EXPECT_EQ(find(kLast + 1).why_not, "the image moves fast");
}

TEST_F(PoseByPatchesTest, NotOnceTheImagesWithoutCornersHaveMovedFar) {
  const FoundPose pose = find(kLast + 1);
  ASSERT_TRUE(pose.found()) << pose.why_not;
  for (double moved = 0; moved < kMaxMotion; moved += *pose.motion) by_patches_.note(pose);
  EXPECT_EQ(find(kLast + 1).why_not, "a keyframe may be due");
  track_up_to_last(Corners::kEnough);
  EXPECT_TRUE(find(kLast + 1).found()) << "an image with corners begins anew";
}

TEST_F(PoseByPatchesTest, SoonAfterAnImageWithEnoughCorners) {
  EXPECT_FALSE(by_patches_.may_do(motion_, walk().utime_us[kLast] + 200'000));
  track_up_to_last(Corners::kFew);
  EXPECT_FALSE(by_patches_.may_do(motion_, next_us_)) << "it blurs or darkens";
  motion_.begin_at(testing::frame_of(kLast));
  EXPECT_FALSE(by_patches_.may_do(motion_, next_us_)) << "nothing is known of the motion";
}

}  // namespace
}  // namespace rumi::front_tracker
