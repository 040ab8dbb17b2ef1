// SPDX-License-Identifier: BSD-3-Clause
#include "base/running/due.h"

#include <gtest/gtest.h>

namespace rumi {
namespace {

TEST(IsDue, OnceThePeriodHasPassed) {
  EXPECT_FALSE(is_due(1999, 1000, 1000));
  EXPECT_TRUE(is_due(2000, 1000, 1000));
  EXPECT_TRUE(is_due(1000, 1000, 0));
}

TEST(IsDue, WhatNeverHappenedIsDueAndSoIsAllAfterTheClockWasSetBack) {
  EXPECT_TRUE(is_due(0, kNever_us, 1'000'000));
  EXPECT_TRUE(is_due(-5, kNever_us, 1'000'000));
  EXPECT_TRUE(is_due(999, 1000, 1'000'000));
}

}  // namespace
}  // namespace rumi
