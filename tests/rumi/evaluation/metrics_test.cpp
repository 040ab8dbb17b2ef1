// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rumi::tool {
namespace {

constexpr int64_t kStart = 1'400'000'000'000'000;
constexpr int64_t kPeriod = 33'333;

// Makes a winding walk of `count` frames at 30 Hz.
std::vector<TimedPose> walk(int count) {
  std::vector<TimedPose> poses;
  for (int i = 0; i < count; ++i) {
    const double t = i / 30.0;
    poses.push_back({kStart + i * kPeriod, SE3(so3_exp({0.1 * t, 0.2 * std::sin(t), 0.3 * std::cos(t)}),
                                               {std::sin(t), 0.5 * t, 0.3 * std::cos(2 * t)})});
  }
  return poses;
}

// Returns the path in another frame and unit.
std::vector<TimedPose> seen_from(const Sim3& other_from_map, std::vector<TimedPose> poses) {
  for (TimedPose& pose : poses) {
    pose.map_from_cam =
        SE3(other_from_map.rotation * pose.map_from_cam.rotation, other_from_map * pose.map_from_cam.translation);
  }
  return poses;
}

std::vector<InputFrame> frames_of(const std::vector<TimedPose>& poses) {
  std::vector<InputFrame> frames;
  for (const TimedPose& pose : poses) frames.push_back({pose.utime_us, "TRACKING", 1, true});
  return frames;
}

const Sim3 kOther(0.37, Eigen::Quaterniond(0.3, 0.5, -0.7, 0.2), {4, -2, 9});

TEST(Metrics, APerfectEstimateInAnotherFrameAndUnitHasNoError) {
  const auto truth = walk(300);
  const auto metrics = evaluate_trajectory(seen_from(kOther, truth), truth);
  EXPECT_EQ(metrics.associated, 300);
  EXPECT_LT(metrics.ate_rmse_m.value(), 1e-9);
  EXPECT_LT(metrics.rpe_trans_m.value(), 1e-9);
  EXPECT_LT(metrics.rpe_rot_deg.value(), 1e-5);
  EXPECT_NEAR(metrics.truth_from_estimate->scale, 1 / 0.37, 1e-9);
  EXPECT_GT(metrics.ate_se3_rmse_m.value(), 0.1) << "the rigid alignment must not repair the scale";
}

TEST(Metrics, ReportsTheNoiseThatWasAdded) {
  const auto truth = walk(3000);
  auto estimate = truth;
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.02);
  for (TimedPose& pose : estimate) {
    pose.map_from_cam.translation += Eigen::Vector3d(noise(random), noise(random), noise(random));
  }
  const auto metrics = evaluate_trajectory(estimate, truth);
  EXPECT_NEAR(metrics.ate_rmse_m.value(), 0.02 * std::sqrt(3), 0.002);
  EXPECT_NEAR(metrics.ate_se3_rmse_m.value(), 0.02 * std::sqrt(3), 0.002);
  EXPECT_NEAR(metrics.rpe_trans_m.value(), 0.02 * std::sqrt(6), 0.003) << "two noisy ends";
  EXPECT_LT(metrics.rpe_rot_deg.value(), 1e-5);
}

TEST(Metrics, ThePathIsTheTrueOneOfThePosesThatAreThere) {
  std::vector<TimedPose> truth;
  for (int i = 0; i <= 100; ++i)
    truth.push_back({kStart + i * kPeriod, SE3(Eigen::Quaterniond::Identity(), {0.01 * i, 0.0001 * i * i, 0})});
  const auto estimate = seen_from(kOther, {truth.begin() + 20, truth.begin() + 81});
  double length_m = 0;
  for (int i = 20; i < 80; ++i) length_m += std::hypot(0.01, 0.0001 * (2 * i + 1));
  EXPECT_NEAR(evaluate_trajectory(estimate, truth).path_m, length_m, 1e-9);
}

TEST(Metrics, RelativeRotationIsThatOfTheInterval) {
  auto truth = walk(300);
  // Otherwise errors in different directions would add up.
  for (TimedPose& pose : truth) pose.map_from_cam.rotation.setIdentity();
  auto estimate = truth;
  // The estimate drifts by half a degree per second about the camera's own axis.
  for (size_t i = 0; i < estimate.size(); ++i) {
    const double angle = 0.5 * M_PI / 180 * static_cast<double>(i) / 30.0;
    estimate[i].map_from_cam = estimate[i].map_from_cam * SE3(so3_exp({0, 0, angle}), Eigen::Vector3d::Zero());
  }
  EXPECT_NEAR(evaluate_trajectory(estimate, truth).rpe_rot_deg.value(), 0.5, 0.02);
  MetricOptions two_seconds;
  two_seconds.rpe_interval_s = 2;
  EXPECT_NEAR(evaluate_trajectory(estimate, truth, two_seconds).rpe_rot_deg.value(), 1.0, 0.04);
}

TEST(Metrics, SaysWhyInsteadOfZero) {
  const auto truth = walk(100);
  for (size_t count : {0u, 1u, 2u}) {
    const auto metrics = evaluate_trajectory({truth.begin(), truth.begin() + count}, truth);
    EXPECT_FALSE(metrics.ate_rmse_m) << count;
    EXPECT_FALSE(metrics.rpe_trans_m) << count;
    EXPECT_THAT(metrics.reason, testing::HasSubstr("needs 3"));
  }
  auto still = truth;
  for (TimedPose& pose : still) pose.map_from_cam.translation = {1, 1, 1};
  EXPECT_FALSE(evaluate_trajectory(still, truth).ate_rmse_m);
  EXPECT_THAT(evaluate_trajectory(still, truth).reason, testing::HasSubstr("one place"));
  const auto brief = evaluate_trajectory({truth.begin(), truth.begin() + 10}, truth);
  EXPECT_TRUE(brief.ate_rmse_m);
  EXPECT_FALSE(brief.rpe_trans_m) << "no second pose a second later";
}

TEST(Metrics, WhatCannotBeComputedWithIsNoNumber) {
  std::vector<TimedPose> truth = walk(30);
  const std::vector<TimedPose> estimate = truth;
  for (TimedPose& pose : truth) pose.map_from_cam.translation *= 1e200;
  const TrajectoryMetrics metrics = evaluate_trajectory(estimate, truth);
  EXPECT_FALSE(metrics.ate_rmse_m);
  EXPECT_FALSE(metrics.reason.empty());
}

TEST(Metrics, RelativeErrorsDoNotBridgeGaps) {
  const auto truth = walk(300);
  std::vector<TimedPose> islands(truth.begin(), truth.begin() + 20);
  islands.insert(islands.end(), truth.begin() + 200, truth.begin() + 220);
  EXPECT_FALSE(evaluate_trajectory(islands, truth).rpe_trans_m);
}

TEST(Associate, PrefersTheSameTimeThenTheNearestWithinTheTolerance) {
  const auto at = [](std::vector<int64_t> times) {
    std::vector<TimedPose> poses;
    for (int64_t t : times) poses.push_back({t, SE3()});
    return poses;
  };
  using Pairs = std::vector<std::pair<size_t, size_t>>;
  EXPECT_EQ(associate(at({100'000}), at({95'000, 100'000, 101'000})), (Pairs{{0, 1}}));
  EXPECT_EQ(associate(at({100'000}), at({79'000, 120'000})), (Pairs{{0, 1}})) << "20 ms";
  EXPECT_TRUE(associate(at({100'000}), at({79'000, 121'000})).empty());
  // Half the frame period (10 ms) is the limit, as it is less than 20 ms.
  EXPECT_EQ(associate(at({0, 20'000, 40'000}), at({8'000, 51'000})), (Pairs{{0, 0}}));
  EXPECT_TRUE(associate({}, at({1})).empty());
  EXPECT_TRUE(associate(at({1}), {}).empty());
}

TEST(RunMetricsTest, RatesCountFramesNotPoses) {
  const auto truth = walk(100);
  const auto frames = frames_of(truth);
  std::vector<TimedPose> map(truth.begin() + 10, truth.begin() + 60);
  map.push_back({truth[60].utime_us + 5, truth[60].map_from_cam});  // there is no frame at that time
  const std::vector<TimedPose> second(truth.begin() + 70, truth.begin() + 90);
  const auto metrics = evaluate_run(seen_from(kOther, map), {map, seen_from(kOther, second)}, frames, truth);
  EXPECT_EQ(metrics.frames, 100);
  EXPECT_EQ(metrics.tracked_frames, 50);
  EXPECT_NEAR(metrics.tracked_frame_ratio.value(), 0.50, 1e-12);
  EXPECT_NEAR(metrics.submap_frame_ratio.value(), 0.70, 1e-12);
  EXPECT_NEAR(metrics.span_rate.value(), 50.0 / 99.0, 1e-5);
  EXPECT_NEAR(metrics.true_rate.value(), 0.50, 1e-12);
}

TEST(RunMetricsTest, ImagesThatNobodyHadTimeForCountAsFrames) {
  const auto truth = walk(100);
  const auto metrics = evaluate_run(truth, {truth}, frames_of(truth), truth, {}, 200);
  EXPECT_EQ(metrics.frames, 200);
  EXPECT_NEAR(metrics.tracked_frame_ratio.value(), 0.5, 1e-12);
  EXPECT_NEAR(metrics.true_rate.value(), 0.5, 1e-12);
  EXPECT_NEAR(metrics.submap_frame_ratio.value(), 0.5, 1e-12);
}

TEST(RunMetricsTest, TrueRateIsNotImprovedByGuesses) {
  const auto truth = walk(1000);
  auto guessed = truth;
  // Ten frames are guessed to be half a metre away.
  for (int i = 500; i < 510; ++i) guessed[i].map_from_cam.translation.z() += 0.5;
  const auto metrics = evaluate_run(guessed, {}, frames_of(truth), truth);
  EXPECT_NEAR(metrics.tracked_frame_ratio.value(), 1.0, 1e-12);
  EXPECT_NEAR(metrics.true_rate.value(), 0.99, 1e-12);
}

TEST(RunMetricsTest, TrueRateIsOfTheFramesThatHaveATruth) {
  const auto all = walk(1000);
  const std::vector<TimedPose> truth(all.begin() + 100, all.begin() + 600);
  auto map = all;
  for (int i = 300; i < 305; ++i) map[i].map_from_cam.translation.z() += 0.5;
  const auto metrics = evaluate_run(map, {}, frames_of(all), truth);
  EXPECT_EQ(metrics.frames_with_truth, 500);
  EXPECT_NEAR(metrics.true_rate.value(), 0.99, 1e-12);
  EXPECT_NEAR(metrics.tracked_frame_ratio.value(), 1.0, 1e-12);
}

TEST(Metrics, WithoutTrueRotationsThereAreNoRelativeErrors) {
  const auto truth = walk(300);
  MetricOptions options;
  options.truth_has_rotations = false;
  const auto metrics = evaluate_trajectory(truth, truth, options);
  EXPECT_LT(metrics.ate_rmse_m.value(), 1e-9);
  EXPECT_FALSE(metrics.rpe_trans_m);
  EXPECT_FALSE(metrics.rpe_rot_deg);
  EXPECT_EQ(metrics.reason, "the truth has no rotations");
}

TEST(RunMetricsTest, AbsentFiguresStayAbsent) {
  const auto truth = walk(100);
  const auto nothing = evaluate_run({}, {}, {}, truth);
  for (const auto& figure :
       {nothing.tracked_frame_ratio, nothing.span_rate, nothing.true_rate, nothing.submap_frame_ratio})
    EXPECT_EQ(figure, std::nullopt);
  const auto lost = evaluate_run({}, {}, frames_of(truth), truth);
  EXPECT_EQ(lost.tracked_frame_ratio, 0.0);
  EXPECT_EQ(lost.true_rate, 0.0) << "no pose is near the truth, and that is known";
  auto other_day = truth;
  for (TimedPose& pose : other_day) pose.utime_us += 86'400'000'000;
  EXPECT_FALSE(evaluate_run(truth, {}, frames_of(truth), other_day).true_rate) << "nothing is known of them";
}

}  // namespace
}  // namespace rumi::tool
