// SPDX-License-Identifier: BSD-3-Clause
#include "base/result.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <memory>

namespace rumi {
namespace {

Result<int> half(int n) {
  if (n % 2 != 0) return Error{"is odd", fmt::format("number {}", n), "give an even one"};
  return n / 2;
}

Result<> must_be_even(int n) {
  if (const Result<int> result = half(n); !result) return result.error();
  return {};
}

TEST(Result, IsAValueOrAnError) {
  const Result<int> good = half(4), bad = half(3);
  ASSERT_TRUE(good);
  EXPECT_EQ(*good, 2);
  EXPECT_EQ(good.error_text(), "");
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error_text(), "number 3: is odd; give an even one");
}

TEST(Result, OfNothingToReturnIsGoodByDefault) {
  EXPECT_TRUE(must_be_even(2));
  EXPECT_EQ(must_be_even(5).error(), (Error{"is odd", "number 5", "give an even one"}));
}

TEST(Result, MovesWhatItHolds) {
  Result<std::unique_ptr<int>> result = std::make_unique<int>(7);
  ASSERT_TRUE(result);
  const std::unique_ptr<int> taken = std::move(*result);
  EXPECT_EQ(*taken, 7);
}

TEST(Error, SaysWhatIsThere) {
  EXPECT_EQ(Error{"is full"}.text(), "is full");
  EXPECT_EQ((Error{"is full", "disk"}).text(), "disk: is full");
  EXPECT_EQ((Error{.what = "is full", .remedy = "delete something"}).text(), "is full; delete something");
}

}  // namespace
}  // namespace rumi
