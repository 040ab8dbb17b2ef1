// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/flags.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "base/command_line/options.h"
#include "camera_driver/source/camera_options.h"

namespace rumi::camera_driver {
namespace {

using ::testing::HasSubstr;

TEST(Flags, ShowTheDefaultsOfTheOptionsThatTheyAreShortFor) {
  CommandLine app("a program", "program");
  std::vector<std::string> settings;
  add_flags(app, {}, &settings);
  const CameraOptions o;
  for (const std::string& shown :
       {fmt::format("--every N={} ", o.every), fmt::format("--start S={} ", o.start_s),
        fmt::format("--duration S={} ", o.duration_s), fmt::format("--rate HZ={} ", o.rate_hz),
        fmt::format("--encoding FORM={} ", o.encoding), fmt::format("--log-channel NAME={} ", o.log_channel),
        fmt::format("--speed N={} ", o.speed), std::string("--camera FILE ")})
    EXPECT_THAT(app.help(), HasSubstr(shown));
}

TEST(Flags, WhatIsNotGivenIsNoSetting) {
  CommandLine app("a program", "program");
  std::vector<std::string> settings;
  add_flags(app, {"--every", "--rate"}, &settings);
  std::string program = "program", flag = "--every", value = "3";
  std::vector<char*> argv = {program.data(), flag.data(), value.data()};
  EXPECT_EQ(app.parse(3, argv.data()).error, "");
  EXPECT_EQ(settings, std::vector<std::string>{by_flag("--every", "camera_driver.every", "3")});
}

}  // namespace
}  // namespace rumi::camera_driver
