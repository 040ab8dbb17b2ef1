// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/refused_images.h"

#include <gmock/gmock.h>

#include "tests/support/captured_log.h"
#include "tests/support/count_of.h"

namespace rumi::front_tracker {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Kind = RefusedImages::Kind;

TEST(RefusedImages, AreSaidOnceOfAKindAndCounted) {
  const testing::CapturedLog log;
  RefusedImages refused;
  for (int i = 0; i < 3; ++i) refused.add(Kind::kSize, "it is 320x240");
  refused.add(Kind::kDamaged, "corrupt JPEG");
  EXPECT_EQ(testing::count_of(log.text(), "it is 320x240"), 1u);
  EXPECT_THAT(log.text(), HasSubstr("corrupt JPEG"));
  EXPECT_EQ(refused.total(), 4);
  EXPECT_EQ(refused.text(), ", 3 images refused: size, 1 images refused: damaged");
  EXPECT_TRUE(refused.take_news());
  EXPECT_FALSE(refused.take_news());
}

TEST(RefusedImages, ThoseThatWaitAreNotSaidAndMayBeTakenBack) {
  const testing::CapturedLog log;
  RefusedImages refused;
  refused.count(Kind::kAhead);
  EXPECT_EQ(refused.of(Kind::kAhead), 1);
  EXPECT_FALSE(refused.take_news());
  refused.take_back(Kind::kAhead, 1);
  EXPECT_EQ(refused.total(), 0);
  EXPECT_EQ(refused.text(), "");
  EXPECT_EQ(log.text(), "");
}

TEST(RefusedImages, AreComplainedOfAboveOnePercent) {
  RefusedImages refused;
  for (int i = 0; i < 75; ++i) refused.add(Kind::kSize, "it is 320x240 but the calibration is for 640x480");
  refused.add(Kind::kDamaged, "corrupt JPEG");
  EXPECT_THAT(refused.complaints(150),
              ElementsAre("75 of 150 images refused: not of the calibration's size (the first: it is 320x240 but the "
                          "calibration is for 640x480); images of another size need a calibration of that size"));
  EXPECT_THAT(refused.complaints(10'000), ElementsAre());
  EXPECT_EQ(refused.complaints(75).size(), 2u);
}

}  // namespace
}  // namespace rumi::front_tracker
