// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/keyframe_policy.h"

#include <gtest/gtest.h>

namespace rumi::front_tracker {
namespace {

constexpr int kKeypoints = 1000;

// A young submap, whose only keyframe, at time 0, has 200 landmarks.
class KeyframePolicyTest : public ::testing::Test {
 protected:
  KeyframePolicyTest() {
    Keyframe& kf = map_.keyframes[0];
    Features features;
    features.keypoints.resize(kKeypoints);
    kf.features = std::make_shared<const Features>(std::move(features));
    for (int id = 0; id < 200; ++id) {
      map_.landmarks[id].id = id;
      kf.landmark_ids.push_back(id);
    }
  }
  static Frame frame(int64_t utime_us, int matches) {
    Frame frame;
    frame.utime_us = utime_us;
    frame.reference_keyframe = 0;
    for (int id = 0; id < matches; ++id) frame.landmark_ids.push_back(id);
    return frame;
  }
  bool is_due(const Frame& frame, double motion = 0) const { return policy_.is_due(map_, frame, motion); }

  Submap map_;
  KeyframePolicy policy_{KeyframeOptions(), kKeypoints};
};

TEST_F(KeyframePolicyTest, WhereLittleOfTheLastOneIsSeen) {
  EXPECT_FALSE(is_due(frame(200'000, 180)));
  EXPECT_TRUE(is_due(frame(200'000, 130)));
  EXPECT_FALSE(is_due(frame(50'000, 130))) << "too soon";
  EXPECT_TRUE(is_due(frame(50'000, 110))) << "the next frame may be too late";
}

TEST_F(KeyframePolicyTest, InFastMotionAndAfterAWhile) {
  EXPECT_TRUE(is_due(frame(200'000, 180), 0.04));
  EXPECT_FALSE(is_due(frame(50'000, 180), 0.04)) << "too soon";
  EXPECT_TRUE(is_due(frame(1'000'000, 180)));
  policy_.note_keyframe(900'000);
  EXPECT_FALSE(is_due(frame(1'100'000, 180)));
}

TEST_F(KeyframePolicyTest, ForASecondAfterTheCameraWasFound) {
  policy_.note_keyframe(10'000'000);
  policy_.note_found_again(10'000'000);
  EXPECT_TRUE(is_due(frame(10'200'000, 200)));
  policy_.note_keyframe(10'900'000);
  EXPECT_FALSE(is_due(frame(11'100'000, 200)));
}

TEST_F(KeyframePolicyTest, TheFirstOfImagesThatBlur) {
  Frame blurred = frame(200'000, 180);
  blurred.corners = Corners::kFew;
  EXPECT_TRUE(is_due(blurred));
  Features few;
  few.keypoints.resize(kKeypoints / 3);
  map_.keyframes[0].features = std::make_shared<const Features>(std::move(few));
  EXPECT_FALSE(is_due(blurred)) << "the last keyframe is one of them";
}

TEST_F(KeyframePolicyTest, NeverWhatIsNothingToBuildOn) {
  Frame f = frame(5'000'000, 20);
  ASSERT_TRUE(is_due(f, 1));
  f.is_believable = false;
  EXPECT_FALSE(is_due(f, 1));
  f.is_believable = true;
  f.corners = Corners::kNone;
  EXPECT_FALSE(is_due(f, 1));
}

}  // namespace
}  // namespace rumi::front_tracker
