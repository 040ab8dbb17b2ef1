// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/slip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/front_tracker/feature_scene.h"
#include "tests/front_tracker/slip.h"

namespace rumi::front_tracker {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Frame tracked(int64_t utime_us, int inliers) {
  Frame frame;
  frame.utime_us = utime_us;
  frame.landmark_ids.assign(inliers, 1);
  return frame;
}

// Keyframes at 0.1, 0.2, 0.3, 0.4 s and, after a slip, at 1.1 and 1.2 s. A frame that sees the same as all of them was
// found again at the fourth.
class WithdrawSlip : public ::testing::Test {
 protected:
  WithdrawSlip() {
    for (int i = 0; i < 6; ++i) poses_.push_back(SyntheticScene::pose(0.1 * i, 0, 0));
    submap_ = scene_.submap({poses_.begin(), poses_.begin() + 4});
    testing::append(*scene_.submap({poses_.begin() + 4, poses_.end()}), submap_.get());
    for (const int64_t utime_us : {900'000, 1'000'000, 1'100'000, 1'200'000}) {
      Frame frame = tracked(utime_us, 0);
      frame.reference_keyframe = 3;
      submap_->add_frame(frame);
    }
    found_ = relocalizer_.relocalize(submap_->map, 3, scene_.frame(5'000'000, poses_[3])).value();
  }
  std::vector<int64_t> withdraw() { return withdraw_slip(relocalizer_, found_, &history_, submap_.get()); }

  FeatureScene scene_{1};
  std::vector<SE3> poses_;
  std::unique_ptr<FrontSubmap> submap_;
  Relocalizer relocalizer_{test_camera(), {}, test_octave_scales()};
  Frame found_;
  SupportHistory history_;
};

TEST_F(WithdrawSlip, FromTheWeakestFrameOnOrOneBeforeItThatIsHardlyStronger) {
  for (const auto& [utime_us, inliers] :
       std::map<int64_t, int>{{400'000, 100}, {900'000, 35}, {1'000'000, 20}, {1'100'000, 90}, {1'200'000, 90}})
    history_.add(tracked(utime_us, inliers));
  EXPECT_THAT(withdraw(), IsEmpty()) << "nothing contradicts";
  testing::slip(submap_.get(), 1'000'000);
  EXPECT_THAT(withdraw(), ElementsAre(900'000, 1'000'000, 1'100'000, 1'200'000));
  EXPECT_EQ(submap_->map.frames.rbegin()->first, 400'000);
  EXPECT_EQ(submap_->map.keyframes.size(), 4u);
  EXPECT_THAT(withdraw(), IsEmpty()) << "once";
}

TEST_F(WithdrawSlip, NotWhereNothingOlderIsLeft) {
  for (const int64_t utime_us : {100'000, 400'000, 1'100'000, 1'200'000})
    history_.add(tracked(utime_us, utime_us == 100'000 ? 20 : 90));
  testing::slip(submap_.get(), 1'000'000);
  EXPECT_THAT(withdraw(), IsEmpty());
  EXPECT_EQ(submap_->map.keyframes.size(), 6u);
}

TEST_F(WithdrawSlip, OnlyOfWhatWasTrackedJustBefore) {
  history_.add(tracked(1'000'000, 20));
  history_.add(tracked(1'200'000, 90));
  testing::slip(submap_.get(), 1'000'000);
  history_.add(tracked(5'300'000, 90));
  EXPECT_THAT(withdraw(), IsEmpty());
}

}  // namespace
}  // namespace rumi::front_tracker
