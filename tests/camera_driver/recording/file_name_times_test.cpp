// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/file_name_times.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace rumi::camera_driver {
namespace {

struct Example {
  const char* name;
  const char* time;
  TimeUnit unit;
};

TEST(FileNameTimes, AreFoundInEveryForm) {
  for (const Example& e : {
           Example{"1305031102.175304.png", "1305031102.175304", TimeUnit::kSeconds},
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
}  // namespace rumi::camera_driver
