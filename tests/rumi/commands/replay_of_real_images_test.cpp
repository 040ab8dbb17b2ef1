// SPDX-License-Identifier: BSD-3-Clause
// Runs `rumi replay` on real recordings, if there are any.
#include <gmock/gmock.h>

#include "tests/rumi/commands/replay_fixture.h"

namespace rumi::tool {
namespace {

fs::path recording(const std::string& name) {
  const char* data = std::getenv("RUMI_DATA_DIR");
  return fs::path(data ? data : RUMI_DEFAULT_DATA_DIR) / name;
}

nlohmann::json figures_of_replay(const fs::path& folder) {
  const TemporaryFolder work;
  const Outcome outcome = shell("$RUMI/rumi replay '" + folder.string() + "' -q -o '" + work.path().string() + "'");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  return evaluate(work.path(), folder / "groundtruth.txt");
}

TEST(ReplayOfRealImages, Redkitchen) {
  const fs::path folder = recording("redkitchen");
  if (!fs::exists(folder / "rgb.txt")) GTEST_SKIP() << "NOT TESTED: no " << folder << " (set RUMI_DATA_DIR)";
  const auto figures = figures_of_replay(folder);
  EXPECT_EQ(figures["frames"], 1000);
  EXPECT_GE(figures["tracked_frame_ratio"], 0.95);
  EXPECT_LE(figures["ate_rmse_m"], 0.08);
}

// The redkitchen recording, made dark and out of focus for 3.7 s. A back submap joins the parts before and after.
TEST(ReplayOfRealImages, RedkitchenSoft) {
  const fs::path folder = recording("redkitchen_soft");
  if (!fs::exists(folder / "rgb.txt")) GTEST_SKIP() << "NOT TESTED: no " << folder << " (set RUMI_DATA_DIR)";
  const auto figures = figures_of_replay(folder);
  EXPECT_GE(figures["tracked_frame_ratio"], 0.97);
  EXPECT_GE(figures["true_rate"], 0.93);
  EXPECT_LE(figures["ate_rmse_m"], 0.06);
}

}  // namespace
}  // namespace rumi::tool
