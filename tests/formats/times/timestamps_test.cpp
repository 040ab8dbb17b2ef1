// SPDX-License-Identifier: BSD-3-Clause
#include "formats/times/timestamps.h"

#include <gtest/gtest.h>

#include "base/text/natural_order.h"
#include "formats/recording/file_list.h"

namespace rumi {
namespace {

std::optional<int64_t> seconds(std::string_view text) { return parse_time_us(text, TimeUnit::kSeconds); }
std::optional<int64_t> nanoseconds(std::string_view text) { return parse_time_us(text, TimeUnit::kNanoseconds); }

TEST(Timestamps, SecondsAreExact) {
  EXPECT_EQ(seconds("1305031102.175304"), 1305031102175304);
  EXPECT_EQ(seconds("1.305031102175304e+09"), 1305031102175304);
  EXPECT_EQ(seconds("1403636579.763555584"), 1403636579763556);
  EXPECT_EQ(seconds("12"), 12000000);
  EXPECT_EQ(seconds("0.0000005"), 1);
  EXPECT_EQ(seconds("0.00000049999"), 0);
  EXPECT_EQ(seconds(".5"), 500000);
  EXPECT_EQ(seconds("5e-1"), 500000);
  // Around a present time, each microsecond differs from its neighbours.
  for (int64_t us = 1999999999000000; us < 1999999999002000; ++us) EXPECT_EQ(seconds(format_seconds(us)), us);
}

TEST(Timestamps, WhatIsNoTimeIsRefused) {
  for (const char* bad :
       {"", ".", "-1", "nan", "inf", "1.2.3", "1e", "1e99", "1e-2147483648", "12s", "0x10", "1,5", " 1", "9007199255",
        "1403636579763555584", "99999999999999999999999999999999999999999999999999999999999999999"})
    EXPECT_FALSE(seconds(bad)) << bad;
  for (const char* bad : {"", "-1", "99999999999999999999999999"}) EXPECT_FALSE(nanoseconds(bad)) << bad;
  EXPECT_EQ(nanoseconds("1403636579763555584"), 1403636579763556);
  EXPECT_EQ(nanoseconds("499"), 0);
}

TEST(FileList, NaturalOrder) {
  EXPECT_TRUE(natural_less("2.png", "10.png"));
  EXPECT_FALSE(natural_less("10.png", "2.png"));
  EXPECT_TRUE(natural_less("a9b2", "a09b10"));
  EXPECT_TRUE(natural_less("a", "a1"));
  EXPECT_NE(natural_less("01", "1"), natural_less("1", "01"));
  EXPECT_FALSE(natural_less("7", "7"));
}

}  // namespace
}  // namespace rumi
