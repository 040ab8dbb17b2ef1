// SPDX-License-Identifier: BSD-3-Clause
#include "formats/times/file_name_times.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace rumi {
namespace {

struct Example {
  const char* name;
  const char* time;
  TimeUnit unit;
};

TEST(FileNameTimes, AreFoundInEveryForm) {
  for (const Example& e : {
           Example{"1305031102.175304.png", "1305031102.175304", TimeUnit::kSeconds},
           Example{"1305031102.0.png", "1305031102.0", TimeUnit::kSeconds},
           Example{"rgb_12.500.png", "12.500", TimeUnit::kSeconds},
           Example{"1403636579763555584.png", "1403636579763555584", TimeUnit::kNanoseconds},
           Example{"cam0_1403636579763555584_left.png", "1403636579763555584", TimeUnit::kNanoseconds},
           Example{"1400000000033333.jpg", "1400000000033333", TimeUnit::kMicroseconds},
           Example{"1400000000033.jpg", "1400000000033", TimeUnit::kMilliseconds},
           Example{"1400000000.jpg", "1400000000", TimeUnit::kSeconds},
           Example{"2026-03-02_10-15-00.250.png", "1772446500.250", TimeUnit::kSeconds},
           Example{"IMG_20260302_101500_250.jpg", "1772446500.250", TimeUnit::kSeconds},
           Example{"2026-03-02T10:15:00.png", "1772446500.0", TimeUnit::kSeconds},
           Example{"20260302101500250.png", "1772446500.250", TimeUnit::kSeconds},
           Example{"16:54:00.033333.png", "60840.033333", TimeUnit::kSeconds},
           Example{"13-05-2014_16-54-00.033.png", "60840.033", TimeUnit::kSeconds},
       }) {
    const FileNameTimes found = times_in_names({e.name});
    EXPECT_EQ(found.times.at(0), e.time) << e.name;
    EXPECT_EQ(found.usual, e.unit) << e.name;
  }
}

TEST(FileNameTimes, NumbersAreNone) {
  for (const char* name : {"00000.png", "frame-000000.color.jpg", "0000000000.png", "0000001403636579.png", "1.5.png",
                           "a.png", "12345678.png", "", ".png", "99999999999999999999999.png", "2026.png"})
    EXPECT_EQ(times_in_names({name}).times.at(0), "") << name;
  std::string long_name(4000, '1');
  long_name += ".png";
  EXPECT_EQ(times_in_names({long_name}).times.at(0), "");
}

TEST(FileNameTimes, WhatMostHave) {
  const FileNameTimes found = times_in_names({"12.5000.png", "12.6000.png", "1403636579763555584.png", "x.png"});
  EXPECT_THAT(found.times, ::testing::ElementsAre("12.5000", "12.6000", "", ""));
}

TEST(FileNameTimes, OfAZoneAreThoseOfUtc) {
  for (const auto& [name, time] : {std::pair{"2026-03-02T10:15:00.250+02:00.png", "1772439300.250"},
                                   {"2026-03-02T10:15:00.250000+0200.png", "1772439300.250000"},
                                   {"2026-03-02T10:15:00+02:00.png", "1772439300.0"},
                                   {"2026-03-02T10:15:00.5-05:30.png", "1772466300.5"},
                                   {"2026-03-02T10:15:00-05:30.png", "1772466300.0"},
                                   {"2026-03-02T10:15:00.250Z.png", "1772446500.250"},
                                   {"20260302T101500Z.png", "1772446500.0"},
                                   {"2026-03-02_10-15-00-0250.png", "1772446500.0250"},
                                   {"2026-03-02_10-15-00-250-0001.png", "1772446500.250"}})
    EXPECT_EQ(times_in_names({name}).times.at(0), time) << name;
}

TEST(FileNameTimes, OfACounterOf32BitsAreContinued) {
  const FileNameTimes found =
      times_in_names({"f_0000032703.jpg", "f_0000066036.jpg", "f_4294933333.jpg", "f_4294966666.jpg"});
  EXPECT_THAT(found.times, ::testing::ElementsAre("4294999999", "4295033332", "4294933333", "4294966666"));
  EXPECT_EQ(found.usual, TimeUnit::kMicroseconds);
}

TEST(FileNameTimes, HexadecimalNumbersAreFound) {
  EXPECT_TRUE(are_hexadecimal({"00000008.jpg", "00000009.jpg", "0000000a.jpg"}));
  EXPECT_TRUE(are_hexadecimal({"frame_0009.jpg", "frame_000A.jpg", "frame_0010.jpg"}));
  for (const std::vector<std::string>& names : {std::vector<std::string>{"008.jpg", "009.jpg", "010.jpg"},
                                                {"00a.jpg", "00b.jpg", "00c.jpg"},
                                                {"08.jpg", "09.jpg", "0a.jpg"},
                                                {"008.jpg", "0010.jpg", "000a.jpg"},
                                                {"008.jpg", "009.jpg", "00x.jpg"},
                                                {}})
    EXPECT_FALSE(are_hexadecimal(names));
}

TEST(FileNameTimes, OfADayGoOnPastMidnight) {
  const FileNameTimes found = times_in_names({"00-00-00.033.jpg", "00-00-01.000.jpg", "23-59-59.966.jpg", "x.jpg"});
  EXPECT_THAT(found.times, ::testing::ElementsAre("86400.033000", "86401.000000", "86399.966", ""));
  EXPECT_NE(found.note, "");
  EXPECT_EQ(times_in_names({"08-00-00.033.jpg", "19-59-59.966.jpg"}).note, "") << "less than half a day apart";
}

TEST(FileNameTimes, ACountBehindTheSecondIsNoPartOfIt) {
  std::vector<std::string> names;
  for (const char* second : {"101459", "101500", "101501"})
    for (int i = 0; i < 15; ++i) names.push_back(fmt::format("20260302_{}_{:03}.jpg", second, i));
  EXPECT_TRUE(times_in_names(names).count_within_second);
  names.erase(names.begin(), names.begin() + 9);
  EXPECT_TRUE(times_in_names(names).count_within_second);

  std::vector<std::string> milliseconds;
  for (int i = 0; i < 60; ++i) milliseconds.push_back(fmt::format("20260302_1015{:02}_{:03}.jpg", i / 30, i % 30 * 33));
  EXPECT_FALSE(times_in_names(milliseconds).count_within_second);
  EXPECT_FALSE(times_in_names({"20260302_101500.jpg", "20260302_101501.jpg"}).count_within_second);
}

}  // namespace
}  // namespace rumi
