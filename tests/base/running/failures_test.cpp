// SPDX-License-Identifier: BSD-3-Clause
#include "base/running/failures.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "tests/support/captured_log.h"

namespace rumi {
namespace {

TEST(Failures, WhatIsThrownBecomesAReason) {
  EXPECT_EQ(thrown_by([] {}), "");
  EXPECT_EQ(thrown_by([] { throw std::runtime_error("it rains"); }), "it rains");
  EXPECT_EQ(thrown_by([] { throw std::runtime_error(""); }), "no reason given");
  EXPECT_EQ(thrown_by([] { throw "it rains"; }), "what was thrown is no std::exception");
}

TEST(Failures, WhatLibrariesThrowNamesNoCodeOfTheirs) {
  const auto missing = [] { std::filesystem::directory_iterator it("/nowhere/at/all"); };
  EXPECT_EQ(thrown_by(missing), "/nowhere/at/all: No such file or directory");
  EXPECT_EQ(thrown_by([] { throw std::bad_alloc(); }), "there is not enough memory");
  EXPECT_EQ(thrown_by([] { YAML::Load("a: b: c"); }), "YAML that cannot be read: line 1: illegal map value");
  EXPECT_EQ(reason_of(std::runtime_error("[json.exception.type_error.302] type must be number, but is string")),
            "JSON that cannot be read or written: type must be number, but is string");
  EXPECT_EQ(
      reason_of(std::runtime_error("OpenCV(4.6.0) ./modules/core/src/alloc.cpp:73: error: (-4:Insufficient memory) "
                                   "Failed to allocate 12 bytes in function 'OutOfMemoryError'\n")),
      "there is not enough memory");
}

TEST(Failures, AreCountedAndToldNowAndThen) {
  const testing::CapturedLog log;
  Failures failures("a walk");
  EXPECT_EQ(failures.text(), "");
  EXPECT_FALSE(failures.take_news());
  for (int64_t now_us = 0; now_us < 100'000'000; now_us += 100'000) failures.note("it rains", now_us);
  failures.note("", 0);
  EXPECT_EQ(failures.count(), 1000);
  EXPECT_EQ(failures.text(), "a walk broke off (1000 so far): it rains");
  EXPECT_TRUE(failures.take_news());
  EXPECT_FALSE(failures.take_news()) << "it was told";
  const std::string lines = log.text();
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2) << lines;
}

}  // namespace
}  // namespace rumi
