// SPDX-License-Identifier: BSD-3-Clause
#include "base/eigen_assert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <functional>
#include <string>

namespace rumi {
namespace {

using ::testing::HasSubstr;

std::string asserted(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::logic_error& e) {
    return e.what();
  }
  return {};
}

// Without the override, each of these assertions would end the process.
TEST(EigenAssert, IsThrownWithWhatAndWhere) {
  Eigen::VectorXd three(3);
  const std::string outside = asserted([&] { three(3) = 1; });
  EXPECT_THAT(outside, HasSubstr("index >= 0 && index < size()"));
  EXPECT_THAT(outside, ::testing::ContainsRegex("DenseCoeffsBase.h:[0-9]+: "));
  const Eigen::MatrixXd two(2, 2);
  EXPECT_THAT(asserted([&] { three = two * three; }), HasSubstr("invalid matrix product"));
  EXPECT_THAT(asserted([&] { three += Eigen::VectorXd::Zero(2); }), HasSubstr("rows() == "));
  EXPECT_NE(asserted([&] { Eigen::SparseMatrix<double>(2, 2).insert(2, 0) = 1; }), "");
  EXPECT_EQ(asserted([&] { three(2) = 1; }), "");
}

}  // namespace
}  // namespace rumi
