// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/run_evaluation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 60;

void write_path(const fs::path& file, int from, int to, double bend) {
  std::ofstream out(file);
  for (int i = from; i < to; ++i) {
    const double t = 0.1 * i;
    out << fmt::format("{:.6f} {:.6f} {:.6f} {:.6f} 0 0 0 1\n", 1'400'000'000.0 + t, t, std::sin(t) + bend * t * t,
                       std::cos(2 * t));
  }
}

class RunEvaluationTest : public ::testing::Test {
 protected:
  RunEvaluationTest() {
    fs::create_directories(out_ / "submaps");
    write_path(out_ / "truth.txt", 0, kFrames, 0);
    std::ofstream frames(out_ / "frames.csv");
    frames << "utime,state,submap,in_map\n";
    for (int i = 0; i < kFrames; ++i)
      frames << fmt::format("{},TRACKING,1,1\n", 1'400'000'000'000'000 + 100'000 * int64_t{i});
  }
  RunEvaluation evaluate() const { return evaluate_folder(out_.string(), (out_ / "truth.txt").string()).value(); }

  testing::TemporaryFolder folder_;
  fs::path out_ = folder_.path();
};

// Submap 1 is bent, as front_tracker left it, but straight in the map.
TEST_F(RunEvaluationTest, TellsASubmapsErrorAsItWasAndInTheMap) {
  write_path(out_ / "trajectory.txt", 0, 50, 0);
  write_path(out_ / "submaps" / "001.txt", 0, 30, 0.05);
  write_path(out_ / "submaps" / "002.txt", 30, 60, 0);
  const RunEvaluation evaluation = evaluate();
  ASSERT_EQ(evaluation.submaps.size(), 2u);
  EXPECT_GT(evaluation.submaps[0].metrics.ate_rmse_m.value(), 0.01);
  EXPECT_LT(evaluation.submaps[0].ate_in_map_rmse_m.value(), 1e-5);
  EXPECT_LT(evaluation.submaps[1].ate_in_map_rmse_m.value(), 1e-5) << "of what is in the map";
  EXPECT_LT(to_json(evaluation)["per_submap"][0]["ate_in_map_rmse_m"].get<double>(), 1e-5);
}

TEST_F(RunEvaluationTest, ASubmapThatIsNotInTheMapHasNoErrorThere) {
  write_path(out_ / "trajectory.txt", 0, 30, 0);
  write_path(out_ / "submaps" / "001.txt", 30, 60, 0);
  const RunEvaluation evaluation = evaluate();
  ASSERT_EQ(evaluation.submaps.size(), 1u);
  EXPECT_LT(evaluation.submaps[0].metrics.ate_rmse_m.value(), 1e-5);
  EXPECT_FALSE(evaluation.submaps[0].ate_in_map_rmse_m);
  EXPECT_TRUE(to_json(evaluation)["per_submap"][0]["ate_in_map_rmse_m"].is_null());
}

// A deviation is in the unit of the file from which the pose is taken: the map's, or that of a submap outside the map.
TEST_F(RunEvaluationTest, TellsHowHonestTheDeviationsAre) {
  write_path(out_ / "trajectory.txt", 0, 30, 0.001);
  write_path(out_ / "submaps" / "001.txt", 0, 30, 1);
  write_path(out_ / "submaps" / "002.txt", 30, 60, 0.001);
  std::ofstream frames(out_ / "frames.csv");
  frames << "utime,state,submap,in_map,position_sigma,rotation_sigma_rad,log_scale_sigma\n";
  for (int i = 0; i < kFrames; ++i)
    frames << fmt::format("{},TRACKING,{},{},{}\n", 1'400'000'000'000'000 + 100'000 * int64_t{i}, i < 30 ? 1 : 2,
                          i < 30 ? 1 : 0, i == 7 ? ",," : "0.01,0.01,0.1");
  frames.close();
  const RunEvaluation evaluation = evaluate();
  EXPECT_EQ(evaluation.honesty.position.counted, kFrames - 1);
  EXPECT_EQ(evaluation.honesty.position.one.value(), 1) << "not as the submap was built";
  EXPECT_FALSE(evaluation.honesty.rotation.one);
  const auto json = to_json(evaluation)["honesty"];
  EXPECT_EQ(json["position"]["within_two"], 1);
  EXPECT_TRUE(json["rotation"]["within_one"].is_null());
  EXPECT_EQ(json["reason"], "the truth has no rotations");
}

TEST_F(RunEvaluationTest, AnOlderRunHasNoDeviations) {
  write_path(out_ / "trajectory.txt", 0, 50, 0);
  const auto json = to_json(evaluate())["honesty"];
  EXPECT_EQ(json["position"]["counted"], 0);
  EXPECT_TRUE(json["position"]["within_one"].is_null());
  EXPECT_NE(json["reason"], "");
}

}  // namespace
}  // namespace rumi::tool
