// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/truth_shift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace rumi::tool {
namespace {

using Path = std::function<Eigen::Vector3d(double)>;

// The path of a hand-held camera that looks about.
Eigen::Vector3d by_hand(double t) {
  return {0.5 * std::sin(0.9 * t) + 0.1 * std::sin(4.1 * t), 0.3 * std::cos(1.3 * t), 0.2 * std::sin(2.3 * t + 1)};
}
Eigen::Vector3d straight_on(double t) { return {0.7 * t, 0, 0}; }
Eigen::Vector3d in_a_circle(double t) { return {std::cos(t), std::sin(t), 0}; }

std::vector<TimedPose> sample(const Path& path, double begin_s, double end_s, double rate_hz, double noise_m = 0) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, noise_m > 0 ? noise_m : 1);
  std::vector<TimedPose> poses;
  for (int i = 0; begin_s + i / rate_hz <= end_s; ++i) {
    const double t = begin_s + i / rate_hz;
    Eigen::Vector3d place = path(t);
    if (noise_m > 0) place += Eigen::Vector3d(noise(random), noise(random), noise(random));
    poses.push_back({std::llround((1000 + t) * 1e6), SE3(Eigen::Quaterniond::Identity(), place)});
  }
  return poses;
}

TEST(TruthShift, OfATruthThatIsLateOrEarlyAsAWholeIsFound) {
  const std::vector<TimedPose> estimate = sample(by_hand, 0, 8, 30, 0.005);
  for (const double late_s : {0.3, -0.3, 0.06, 1.0, -1.7}) {
    const std::vector<TimedPose> truth = shifted(sample(by_hand, -4, 12, 100), late_s);
    const std::optional<TruthShift> found = find_truth_shift(estimate, truth);
    ASSERT_TRUE(found) << late_s;
    EXPECT_NEAR(found->seconds, -late_s, 0.011);
    EXPECT_LT(found->ate_rmse_m, 0.012);
  }
}

TEST(TruthShift, IsFoundWhereTheTruthIsNoLongerThanTheRecording) {
  const std::vector<TimedPose> estimate = sample(by_hand, 0, 3, 30, 0.005);
  const std::optional<TruthShift> found = find_truth_shift(estimate, shifted(sample(by_hand, 0, 3, 30), 0.3));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->seconds, -0.3, 0.011);
}

TEST(TruthShift, IsNotClaimedOfATruthThatIsRight) {
  EXPECT_FALSE(find_truth_shift(sample(by_hand, 0, 8, 30, 0.005), sample(by_hand, -4, 12, 100)));
  EXPECT_FALSE(find_truth_shift(sample(by_hand, 0, 8, 30), sample(by_hand, 0, 8, 30))) << "no error at all";
  EXPECT_FALSE(find_truth_shift(sample(by_hand, 0, 8, 30, 0.2), shifted(sample(by_hand, -4, 12, 100), 0.05)))
      << "the shift is the least of its errors";
  EXPECT_FALSE(find_truth_shift(sample(by_hand, 0, 8, 30, 0.005), sample(in_a_circle, -4, 12, 100)))
      << "the truth of something else";
}

TEST(TruthShift, OfAnEvenPathNobodyKnows) {
  for (const Path& path : {Path(straight_on), Path(in_a_circle)}) {
    EXPECT_FALSE(find_truth_shift(sample(path, 0, 8, 30, 0.005), shifted(sample(path, -4, 12, 100), 0.3)));
    EXPECT_FALSE(find_truth_shift(sample(path, 0, 8, 30, 0.005), sample(path, -4, 12, 100)));
  }
  const Path to_and_fro = [](double t) { return Eigen::Vector3d(std::sin(3 * t), 0.3 * std::sin(6 * t), 0); };
  EXPECT_FALSE(find_truth_shift(sample(to_and_fro, 0, 8, 30, 0.005), shifted(sample(to_and_fro, -9, 17, 100), 0.3)))
      << "two seconds later it is the same once more";
}

TEST(TruthShift, NeedsPosesThatHaveATruth) {
  EXPECT_FALSE(find_truth_shift({}, sample(by_hand, 0, 8, 30)));
  EXPECT_FALSE(find_truth_shift(sample(by_hand, 0, 8, 30), {}));
  EXPECT_FALSE(find_truth_shift(sample(by_hand, 0, 0.2, 30), sample(by_hand, 0.1, 0.3, 30)));
}

}  // namespace
}  // namespace rumi::tool
