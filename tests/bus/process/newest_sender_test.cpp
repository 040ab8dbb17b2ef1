// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/newest_sender.h"

#include <gtest/gtest.h>

namespace rumi {
namespace {

constexpr int64_t kSecond = 1'000'000;

TEST(NewestSender, TakesWhatRises) {
  NewestSender sender("RUMI_TRACK");
  for (const int64_t second : {7, 7, 8, 8, 20}) EXPECT_TRUE(sender.take(kSecond * second, kSecond * second));
  EXPECT_EQ(sender.refused(), 0);
}

TEST(NewestSender, RefusesTheOlderOneOfTwo) {
  NewestSender sender("RUMI_TRACK");
  EXPECT_TRUE(sender.take(7, kSecond)) << "nobody else is there yet";
  for (int i = 1; i < 100; ++i) {
    EXPECT_TRUE(sender.take(8, i * kSecond));
    EXPECT_FALSE(sender.take(7, i * kSecond));
    EXPECT_TRUE(sender.is_older(7, i * kSecond));
  }
  EXPECT_EQ(sender.refused(), 99);
}

TEST(NewestSender, TheOlderOneMayGoOnWhenTheNewerOneIsSilent) {
  NewestSender sender("RUMI_TRACK");
  EXPECT_TRUE(sender.take(8, kSecond));
  EXPECT_FALSE(sender.take(7, 5 * kSecond));
  EXPECT_TRUE(sender.take(7, 7 * kSecond));
  EXPECT_TRUE(sender.take(7, 8 * kSecond));
}

TEST(NewestSender, ANumberOfTheFutureSilencesNobody) {
  NewestSender sender("RUMI_TRACK");
  EXPECT_TRUE(sender.take(7 * kSecond, 7 * kSecond));
  EXPECT_TRUE(sender.take(INT64_MAX, 8 * kSecond));
  EXPECT_FALSE(sender.take(INT64_MIN, 9 * kSecond));
  EXPECT_TRUE(sender.take(7 * kSecond, 9 * kSecond));
}

TEST(NewestSender, ALittleLateIsNotOlder) {
  NewestSender sender("RUMI_MAP_STATUS", kLateUs);
  EXPECT_TRUE(sender.take(100 * kSecond, 100 * kSecond));
  EXPECT_TRUE(sender.take(99 * kSecond, 100 * kSecond));
  EXPECT_FALSE(sender.take(90 * kSecond, 100 * kSecond));
}

}  // namespace
}  // namespace rumi
