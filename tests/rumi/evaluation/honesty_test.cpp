// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/honesty.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rumi::tool {
namespace {

constexpr int64_t kStart = 1'400'000'000'000'000;
constexpr int kFrames = 3000;
// Standard deviations of the noise in the generated poses, in metres and radians.
constexpr double kPosition = 0.02, kRotation = 0.01;
constexpr double kUnit = 0.37;   // metres per unit of the submap, before it drifts
constexpr double kDrift = 0.02;  // standard deviation by which log scale drifts in a second

struct NoisyRun {
  std::vector<TimedPose> truth;
  std::vector<ToldPose> told;
};

// Makes a winding walk at 20 Hz, in another frame and unit than the truth, with noise. The told deviations are
// `confidence` times too small. The unit drifts, too.
NoisyRun noisy_run(double confidence, double drift = kDrift, int64_t period_us = 50'000) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 1);
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
  };
  const Eigen::Quaterniond turned = Eigen::Quaterniond(0.3, 0.5, -0.7, 0.2).normalized();
  NoisyRun run;
  Eigen::Vector3d position(4, -2, 9), before = Eigen::Vector3d::Zero();
  double log_scale = 0, variance = 0;
  for (int i = 0; i < kFrames; ++i) {
    const int64_t utime_us = kStart + i * period_us;
    const double t = 1e-6 * static_cast<double>(i * period_us), dt = 1e-6 * static_cast<double>(period_us);
    const SE3 truth(so3_exp({0.1 * t, 0.2 * std::sin(t), 0.3 * std::cos(t)}),
                    {2 * std::sin(t), 0.8 * t, std::cos(1.3 * t)});
    if (i > 0) {
      log_scale += drift * std::sqrt(dt) * normal(random);
      variance += drift * drift * dt;
      position += std::exp(log_scale) / kUnit * (turned * (truth.translation - before));
    }
    before = truth.translation;
    const double unit = std::exp(log_scale) / kUnit;
    const SE3 pose(turned * truth.rotation * so3_exp(noise(kRotation)), position + noise(kPosition * unit));
    run.truth.push_back({utime_us, truth});
    run.told.push_back(
        {{utime_us, pose},
         pose_sigmas(kPosition * unit / confidence, kRotation / confidence, std::sqrt(variance) / confidence)});
  }
  return run;
}

void expect_shares(const WithinSigmas& within, double one, double two, double tolerance) {
  EXPECT_NEAR(within.one.value(), one, tolerance);
  EXPECT_NEAR(within.two.value(), two, tolerance);
}

TEST(Honesty, IsThatOfAGaussianWhereTheDeviationsAreRight) {
  const NoisyRun run = noisy_run(1);
  const Honesty honesty = evaluate_honesty({run.told}, run.truth);
  EXPECT_EQ(honesty.position.counted, kFrames);
  EXPECT_EQ(honesty.rotation.counted, kFrames);
  EXPECT_GT(honesty.log_scale.counted, kFrames / 2);
  EXPECT_EQ(honesty.reason, "");
  expect_shares(honesty.position, 0.683, 0.954, 0.03);
  expect_shares(honesty.rotation, 0.683, 0.954, 0.03);
  // The shares are larger than .683 and .954. The length of a step averages the drift within it, so two consecutive
  // steps differ by less than the growth of the variance says.
  expect_shares(honesty.log_scale, 0.72, 0.96, 0.06);
}

TEST(Honesty, TellsWhoIsTooSure) {
  const NoisyRun run = noisy_run(3);
  const Honesty honesty = evaluate_honesty({run.told}, run.truth);
  for (const WithinSigmas& within : {honesty.position, honesty.rotation}) {
    EXPECT_LT(within.one.value(), 0.1);
    EXPECT_LT(within.two.value(), 0.4);
  }
  EXPECT_LT(honesty.log_scale.one.value(), 0.4);
  EXPECT_LT(honesty.log_scale.two.value(), 0.7);
}

TEST(Honesty, TellsWhoIsNotSureEnough) {
  const NoisyRun run = noisy_run(1.0 / 3);
  const Honesty honesty = evaluate_honesty({run.told}, run.truth);
  EXPECT_GT(honesty.position.one.value(), 0.99);
  EXPECT_GT(honesty.rotation.one.value(), 0.99);
  EXPECT_GT(honesty.log_scale.one.value(), 0.95);
}

// By the end the unit has changed by a third. Only its drift within the interval counts as an error of the position; it
// is small, but no deviation describes it.
TEST(Honesty, TheDriftOfTheUnitBeforeIsNoErrorOfThePosition) {
  const NoisyRun run = noisy_run(1, 0.03);
  expect_shares(evaluate_honesty({run.told}, run.truth).position, 0.66, 0.94, 0.06);
}

TEST(Honesty, DriftOfTheUnitMayBeTold) {
  const NoisyRun run = noisy_run(1, 0.1);
  EXPECT_GT(evaluate_honesty({run.told}, run.truth).log_scale.one.value(), 0.6);
  NoisyRun untold = run;
  for (ToldPose& told : untold.told) told.sigmas.log_scale = 0.5F;
  EXPECT_LT(evaluate_honesty({untold.told}, run.truth).log_scale.one.value(), 0.5) << "said not to drift";
}

TEST(Honesty, AtALowRateAsManyNeighboursAreTaken) {
  const NoisyRun run = noisy_run(1, kDrift, 250'000);
  const Honesty honesty = evaluate_honesty({run.told}, run.truth);
  EXPECT_EQ(honesty.position.counted, kFrames - 8) << "the first and the last have too few";
  expect_shares(honesty.rotation, 0.683, 0.954, 0.03);
}

TEST(Honesty, SaysWhatCannotBeMeasured) {
  NoisyRun run = noisy_run(1);
  EXPECT_FALSE(evaluate_honesty({}, run.truth).position.one);
  EXPECT_THAT(evaluate_honesty({}, run.truth).reason, testing::HasSubstr("no deviation"));
  EXPECT_FALSE(evaluate_honesty({run.told}, {}).position.one);
  EXPECT_FALSE(evaluate_honesty({{run.told.begin(), run.told.begin() + 8}}, run.truth).position.one);
  for (TimedPose& pose : run.truth) pose.map_from_cam.rotation.setIdentity();
  const Honesty without_rotations = evaluate_honesty({run.told}, run.truth);
  EXPECT_TRUE(without_rotations.position.one);
  EXPECT_FALSE(without_rotations.rotation.one);
  EXPECT_THAT(without_rotations.reason, testing::HasSubstr("no rotations"));
  // A camera that stands still does not show the unit.
  for (ToldPose& told : run.told) told.pose.map_from_cam.translation.setOnes();
  EXPECT_FALSE(evaluate_honesty({run.told}, run.truth).position.one);
  EXPECT_FALSE(evaluate_honesty({run.told}, run.truth).log_scale.one);
}

}  // namespace
}  // namespace rumi::tool
