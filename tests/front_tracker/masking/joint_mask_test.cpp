// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/masking/joint_mask.h"

#include <gtest/gtest.h>

namespace rumi::front_tracker {
namespace {

// Returns a mask that leaves out the columns from `first` to the one before `end`.
ImageMask columns(int first, int end) {
  cv::Mat pixels(10, 100, CV_8U, cv::Scalar(255));
  pixels.colRange(first, end).setTo(0);
  return ImageMask(pixels);
}

TEST(JointMask, ShowsWhatBothShow) {
  JointMask joint;
  EXPECT_TRUE(joint.join({}, {}).is_everything());
  const ImageMask left = columns(0, 20), right = columns(90, 100);
  EXPECT_NEAR(joint.join(left, {}).left_out(), 0.2, 1e-9);
  EXPECT_NEAR(joint.join({}, right).left_out(), 0.1, 1e-9);
  EXPECT_NEAR(joint.join(left, right).left_out(), 0.3, 1e-9);
  EXPECT_TRUE(joint.join({}, {}).is_everything());
}

TEST(JointMask, IsMadeOnceForTheSameTwo) {
  JointMask joint;
  const ImageMask left = columns(0, 20), right = columns(90, 100);
  const uchar* made = joint.join(left, right).pixels().data;
  const ImageMask same = left;
  EXPECT_EQ(joint.join(same, right).pixels().data, made);
  EXPECT_NE(joint.join(right, left).pixels().data, nullptr);
}

// Another mask may get the memory of a freed one. It must not be taken for the freed one.
TEST(JointMask, AMaskThatFollowsAnotherIsNotTakenForIt) {
  JointMask joint;
  const ImageMask still = columns(50, 60);
  for (int i = 0; i < 40; ++i) {
    const int width = 1 + i % 5;
    const ImageMask given = columns(0, width);
    ASSERT_NEAR(joint.join(given, still).left_out(), 0.1 + 0.01 * width, 1e-9);
    ASSERT_NEAR(joint.join(still, given).left_out(), 0.1 + 0.01 * width, 1e-9);
  }
}

}  // namespace
}  // namespace rumi::front_tracker
