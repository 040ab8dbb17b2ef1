// SPDX-License-Identifier: BSD-3-Clause
#include "formats/times/time_unit.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace rumi {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Returns the times of 90 images at this rate, in a unit that has `per_second` to the second.
std::vector<std::string> times(double per_second, double rate_hz, double first_s = 1.4e9) {
  std::vector<std::string> all;
  for (int i = 0; i < 90; ++i) all.push_back(fmt::format("{:.6f}", (first_s + i / rate_hz) * per_second));
  return all;
}

TEST(TimeUnit, IsTheUsualOneWhereThatCanBe) {
  for (const double rate_hz : {0.1, 1.0, 5.0, 30.0, 200.0, 1000.0}) {
    const ChosenUnit seconds = choose_time_unit(times(1, rate_hz), TimeUnit::kSeconds);
    EXPECT_EQ(seconds.unit, TimeUnit::kSeconds) << rate_hz;
    EXPECT_EQ(seconds.note, "") << rate_hz;
    EXPECT_EQ(choose_time_unit(times(1e9, rate_hz), TimeUnit::kNanoseconds).note, "") << rate_hz;
  }
  EXPECT_EQ(choose_time_unit({}, TimeUnit::kSeconds).note, "");
  EXPECT_EQ(choose_time_unit({"5", "5", "5"}, TimeUnit::kNanoseconds).note, "");
  EXPECT_EQ(choose_time_unit({"a", "b", "c"}, TimeUnit::kSeconds).note, "");
}

TEST(TimeUnit, IsToldByTheRateAndSaid) {
  const std::pair<double, TimeUnit> units[] = {{1, TimeUnit::kSeconds},
                                               {1e3, TimeUnit::kMilliseconds},
                                               {1e6, TimeUnit::kMicroseconds},
                                               {1e9, TimeUnit::kNanoseconds}};
  for (const double first_s : {0.0, 1000.0, 1.4e9})  // since the start, and since 1970
    for (const auto& [per_second, unit] : units)
      for (const auto& [unused, usual] : units) {
        const ChosenUnit chosen = choose_time_unit(times(per_second, 30, first_s), usual);
        EXPECT_EQ(chosen.unit, unit) << first_s << " " << per_second << " as " << name_of(usual);
        if (unit == usual)
          EXPECT_EQ(chosen.note, "");
        else
          EXPECT_THAT(chosen.note, AllOf(HasSubstr(name_of(unit)), HasSubstr(name_of(usual)), HasSubstr("30 images")));
      }
}

TEST(TimeUnit, SomeWrongTimesDoNotMatter) {
  std::vector<std::string> broken = times(1e6, 20);
  broken[10] = "0";
  broken[20] = "nan";
  broken[30] = "9e15";
  EXPECT_EQ(choose_time_unit(broken, TimeUnit::kNanoseconds).unit, TimeUnit::kMicroseconds);
}

}  // namespace
}  // namespace rumi
