// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/pose_sigmas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rumi {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

TEST(PoseSigmas, AreKnownAllThreeOrNotAtAll) {
  EXPECT_FALSE(PoseSigmas().are_known());
  EXPECT_FALSE(pose_sigmas(0, 0, 0).are_known()) << "a message that says nothing";
  EXPECT_EQ(pose_sigmas(0.5, 0.25, 0), (PoseSigmas{0.5F, 0.25F, 0})) << "the unit is known where the submap begins";
  for (const double bad : {-1.0, -1e-9, kNan, kInfinite, -kInfinite, 1.1e6, 1e300}) {
    EXPECT_EQ(pose_sigmas(bad, 0.1, 0.1), PoseSigmas()) << bad;
    EXPECT_EQ(pose_sigmas(0.1, bad, 0.1), PoseSigmas()) << bad;
    EXPECT_EQ(pose_sigmas(0.1, 0.1, bad), PoseSigmas()) << bad;
  }
  EXPECT_EQ(pose_sigmas(0.1, 0, 0.1), PoseSigmas());
  EXPECT_EQ(pose_sigmas(1e-300, 0.1, 0.1), PoseSigmas()) << "0 as a float";
}

TEST(PoseSigmas, OnlyTheLengthHasAUnit) {
  EXPECT_EQ(scaled({0.5F, 0.25F, 0.125F}, 4), (PoseSigmas{2, 0.25F, 0.125F}));
  EXPECT_EQ(scaled({0.5F, 0.25F, 0.125F}, 1), (PoseSigmas{0.5F, 0.25F, 0.125F})) << "to the bit";
  EXPECT_EQ(scaled({}, 4), PoseSigmas());
  for (const double bad : {0.0, -1.0, kNan, 1e9}) EXPECT_EQ(scaled({0.5F, 0.25F, 0.125F}, bad), PoseSigmas()) << bad;
}

}  // namespace
}  // namespace rumi
