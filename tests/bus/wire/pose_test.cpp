// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/pose.h"

#include <gtest/gtest.h>

#include <limits>

#include "bus/transport/bus.h"
#include "lcmtypes/rumi/track_t.hpp"

namespace rumi {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Pose, TransformsSurviveTheWire) {
  const SE3 pose(Eigen::Quaterniond(0.3, -0.2, 0.7, 0.1), Eigen::Vector3d(1, -2, 3));
  EXPECT_EQ(from_wire(to_wire(pose))->rotation.coeffs(), pose.rotation.coeffs());
  EXPECT_EQ(to_wire(5, pose).utime, 5);
  EXPECT_EQ(to_wire(5, pose).quat[0], pose.rotation.w());
  const Sim3 similarity(2.5, pose.rotation, pose.translation);
  EXPECT_EQ(from_wire(to_wire(similarity))->scale, 2.5);
  for (double scale : {0.0, -1.0, kNan}) {
    similarity_t wire = to_wire(similarity);
    wire.scale = scale;
    EXPECT_FALSE(from_wire(wire));
  }
}

TEST(Pose, DeviationsSurviveATrack) {
  track_t track{};
  EXPECT_EQ(sigmas_of(track), PoseSigmas());
  put_sigmas({0.5F, 0.01F, 0.3F}, &track);
  const std::vector<uint8_t> bytes = encode_message(track);
  track_t received;
  ASSERT_GT(received.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
  EXPECT_EQ(sigmas_of(received), (PoseSigmas{0.5F, 0.01F, 0.3F}));
  put_sigmas({}, &track);
  EXPECT_EQ(track.position_sigma, -1);
  EXPECT_EQ(track.log_scale_sigma, -1);
  track.position_sigma = static_cast<float>(kNan);
  EXPECT_EQ(sigmas_of(track), PoseSigmas());
}

}  // namespace
}  // namespace rumi
