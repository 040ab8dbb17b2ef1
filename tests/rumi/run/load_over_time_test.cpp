// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/load_over_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace rumi::tool {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(LoadOverTime, NotesOncePerInterval) {
  LoadOverTime load;
  for (int i = 0; i <= 300; ++i) load.note(1'000'000 + 100'000 * i, {{"front_tracker", 0.02 * i}, {"map_server", 0}});
  const ProcessLoad read = load_from_json(load.to_json());
  ASSERT_EQ(read.memory_mb.at("replay").size(), 7U);
  EXPECT_GT(read.memory_mb.at("replay").front().second, 1);
  EXPECT_THAT(read.cpu_percent.at("map_server").front(), Pair(5, 0));
  for (const auto& [at_s, percent] : read.cpu_percent.at("front_tracker")) EXPECT_NEAR(percent, 20, 1e-9) << at_s;
}

TEST(LoadOverTime, WhatIsNoneGivesNoLoad) {
  for (const char* text : {"null", "3", "{}", R"({"s": [1, 2], "memory_mb": "much", "cpu_s": {}})",
                           R"({"s": [1], "memory_mb": [1], "cpu_s": [2]})"})
    EXPECT_TRUE(load_from_json(nlohmann::ordered_json::parse(text)).cpu_percent.empty()) << text;
}

TEST(LoadOverTime, TimesThatStandStillGiveNoRate) {
  const ProcessLoad load = load_from_json(
      nlohmann::ordered_json::parse(R"({"s": [0, 5, 5, 10], "memory_mb": [1, 2, 3], "cpu_s": {"a": [0, 1, 2, 3]}})"));
  EXPECT_THAT(load.cpu_percent.at("a"), ElementsAre(Pair(5, 20), Pair(10, 20)));
  EXPECT_EQ(load.memory_mb.at("replay").size(), 3U);
}

}  // namespace
}  // namespace rumi::tool
