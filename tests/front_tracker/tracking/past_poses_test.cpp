// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/past_poses.h"

#include <gtest/gtest.h>

#include "front_tracker/relocalization/relocalizer.h"
#include "tests/front_tracker/feature_scene.h"

namespace rumi::front_tracker {
namespace {

SE3 pose(int i) { return SyntheticScene::pose(0.03 * i, 0, 0); }
int64_t utime_us(int i) { return 10'000'000 + 100'000 * i; }

// A camera moves along. It takes the frames 0 to 9, in a submap with the true poses of three of them.
class PastPosesTest : public ::testing::Test {
 protected:
  PastPosesTest() : submap_(scene_.submap({pose(0), pose(4), pose(8)})) {}
  Frame posed(int i) {
    Frame frame = scene_.frame(utime_us(i), pose(i));
    frame.cam_from_submap = pose(i);
    frame.reference_keyframe = 0;
    return frame;
  }
  void expect_true(int i) {
    const FramePose* found = submap_->map.frame(utime_us(i));
    ASSERT_NE(found, nullptr) << i;
    EXPECT_LT((submap_->map.cam_from_submap(*found).center() - pose(i).center()).norm(), 0.01) << i;
  }

  FeatureScene scene_{4};
  FeatureScene elsewhere_{5};
  std::unique_ptr<FrontSubmap> submap_;
  PastPoses past_{TrackingOptions()};
};

TEST_F(PastPosesTest, OfALossAreTrackedBackUpToTheFirstGap) {
  std::deque<Frame> lost;
  for (int i = 0; i < 9; ++i)
    lost.push_back(i == 3 ? elsewhere_.frame(utime_us(i), pose(i)) : scene_.frame(utime_us(i), pose(i)));
  const auto found_again = Relocalizer(test_camera(), {}, test_octave_scales())
                               .relocalize(submap_->map, 2, scene_.frame(utime_us(9), pose(9)));
  ASSERT_TRUE(found_again);
  const std::vector<Frame> found = past_.track_back(*found_again, lost, submap_.get());
  ASSERT_EQ(found.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(found[i].utime_us, utime_us(4 + i)) << "in order of time";
    expect_true(4 + i);
  }
  EXPECT_EQ(submap_->map.frame(utime_us(2)), nullptr) << "nothing leads there";
}

TEST_F(PastPosesTest, OfABeginningAreFilledInFromBothSides) {
  std::vector<Frame> frames;
  frames.reserve(10);
  for (int i = 0; i < 10; ++i) frames.push_back(i == 4 ? posed(i) : scene_.frame(utime_us(i), pose(i)));
  frames[8] = elsewhere_.frame(utime_us(8), pose(8));
  std::vector<bool> has_pose(10, false);
  has_pose[4] = true;
  past_.fill_in(&frames, &has_pose, submap_.get());
  EXPECT_EQ(has_pose, std::vector<bool>({1, 1, 1, 1, 1, 1, 1, 1, 0, 0}));
  for (const int i : {0, 3, 5, 7}) expect_true(i);
}

TEST_F(PastPosesTest, ACertaintyIsOfWhatIsSeenFromThere) {
  const PoseCertainty known = past_.certainty_at(posed(4), *submap_);
  EXPECT_GT(known.image_px, 0);
  EXPECT_LT(known.image_px, 1);
  Frame foreign = elsewhere_.frame(utime_us(4), pose(4));
  foreign.cam_from_submap = pose(4);
  foreign.reference_keyframe = 0;
  EXPECT_TRUE(past_.certainty_at(foreign, *submap_).twist_covariance.isZero());
}

}  // namespace
}  // namespace rumi::front_tracker
