// SPDX-License-Identifier: BSD-3-Clause
#include "formats/times/odd_times.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace rumi {
namespace {

using ::testing::ElementsAre;

TEST(OddTimes, DecimalsWithoutLeadingZerosAreCounts) {
  std::vector<std::string> times;
  for (int i = 0; i < 60; ++i) times.push_back(fmt::format("{}.{}", 1400000000 + i / 30, i % 30 * 33333));
  EXPECT_NE(give_decimals_their_zeros(&times), "");
  EXPECT_EQ(times[0], "1400000000.000000");
  EXPECT_EQ(times[1], "1400000000.033333");
  EXPECT_EQ(times[29], "1400000000.966657");
}

TEST(OddTimes, DecimalsWithoutTrailingZerosStay) {
  std::vector<std::string> times;
  for (int i = 0; i < 60; ++i) {
    times.push_back(fmt::format("{}.{:06}", 1400000000 + i / 30, i % 30 * 33330));
    while (times.back().ends_with('0')) times.back().pop_back();
  }
  times[0] = times[30] = "1400000000.0";
  const std::vector<std::string> before = times;
  EXPECT_EQ(give_decimals_their_zeros(&times), "");
  EXPECT_EQ(times, before);
  for (const auto& others :
       {std::vector<std::string>{}, {"1.5"}, {"1", "2.50", "3.500", "4"}, {"a.5", "b.500", "", "."}}) {
    times = others;
    EXPECT_EQ(give_decimals_their_zeros(&times), "");
  }
}

TEST(OddTimes, ACounterOf32BitsIsContinued) {
  std::vector<std::string> times = {"4294900000", "4294933333", "4294966666", "32703", "66036"};
  EXPECT_NE(continue_32_bits(&times), "");
  EXPECT_THAT(times, ElementsAre("4294900000", "4294933333", "4294966666", "4294999999", "4295033332"));
  times = {"0000032703", "0000066036", "4294900000", "4294933333", "4294966666"};
  EXPECT_NE(continue_sorted_32_bits(&times), "");
  EXPECT_THAT(times, ElementsAre("4294999999", "4295033332", "4294900000", "4294933333", "4294966666"));
}

TEST(OddTimes, OtherNumbersAreNotContinued) {
  for (const auto& others : {std::vector<std::string>{"1", "2", "3", "4"},
                             {"10", "20", "30", "4294900000"},
                             {"4294967294", "4294967295", "0", "1", "2"},
                             {"1305031102175304", "1305031102211214", "5", "6"},
                             {"4294900000", "4294933333", "x", "66036"},
                             {}}) {
    std::vector<std::string> times = others;
    EXPECT_EQ(continue_32_bits(&times), "");
    EXPECT_EQ(continue_sorted_32_bits(&times), "");
    EXPECT_EQ(times, others);
  }
}

}  // namespace
}  // namespace rumi
