// SPDX-License-Identifier: BSD-3-Clause
#include "base/failures.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace rumi {
namespace {

TEST(Failures, WhatIsThrownBecomesAReason) {
  EXPECT_EQ(thrown_by([] {}), "");
  EXPECT_EQ(thrown_by([] { throw std::runtime_error("it rains"); }), "it rains");
  EXPECT_EQ(thrown_by([] { throw std::runtime_error(""); }), "no reason given");
  EXPECT_EQ(thrown_by([] { throw "it rains"; }), "what was thrown is no std::exception");
}

TEST(Failures, AreCountedAndToldNowAndThen) {
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  Failures failures("a walk");
  EXPECT_EQ(failures.text(), "");
  EXPECT_FALSE(failures.take_news());
  for (int64_t now_us = 0; now_us < 100'000'000; now_us += 100'000) failures.note("it rains", now_us);
  failures.note("", 0);
  spdlog::set_default_logger(before);
  EXPECT_EQ(failures.count(), 1000);
  EXPECT_EQ(failures.text(), "a walk broke off (1000 so far): it rains");
  EXPECT_TRUE(failures.take_news());
  EXPECT_FALSE(failures.take_news()) << "it was told";
  const std::string lines = log.str();
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2) << lines;
}

}  // namespace
}  // namespace rumi
