// SPDX-License-Identifier: BSD-3-Clause
// Runs `rumi replay` on a recording with a loss, and reads the outputs.
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "map_server/store/map_store.h"
#include "tests/rumi/commands/replay_fixture.h"

namespace rumi::tool {
namespace {

using ::testing::HasSubstr;

// The camera turns too fast. front_tracker begins a new submap after the turn, and ruminator rebuilds a back submap
// from the images of the turn.
class ReplayOfALoss : public ReplayTest {
 protected:
  static void SetUpTestSuite() {
    work_ = new TemporaryFolder;
    sequence_ = render(*work_, "--seconds 10 --hard rotation --at 4 --for 1.5");
    outcome_ = replay_aloud(sequence_, work_->path() / "out");
  }
  void SetUp() override { ASSERT_EQ(outcome_.exit_code, 0) << outcome_.output; }
  static int accepted_links(const fs::path& out) {
    const map_server::Atlas atlas = map_server::MapStore::open((out / "map.db").string()).value().load().value();
    return static_cast<int>(std::count_if(atlas.links().begin(), atlas.links().end(),
                                          [](const map_server::Link& link) { return link.accepted(); }));
  }
  static Outcome outcome_;
};
Outcome ReplayOfALoss::outcome_;

TEST_F(ReplayOfALoss, LeavesOneMap) {
  const fs::path out = work_->path() / "out";
  const auto figures = evaluate(out, sequence_ / "groundtruth.txt");
  EXPECT_GE(figures["submaps"], 3);
  // Without the back submap, the turn would have no poses: 1.5 s of 10 s.
  EXPECT_GE(figures["tracked_frame_ratio"], 0.92);
  EXPECT_GE(figures["true_rate"], 0.92);
  EXPECT_LE(figures["ate_rmse_m"], 0.05);
  EXPECT_GE(accepted_links(out), 2);
}

// The output says each of these once: that the submap begins, the loss, the window, the joined map, and the results.
TEST_F(ReplayOfALoss, IsTold) {
  const auto lines = [&](const std::string& words) {
    std::istringstream text(outcome_.output);
    int count = 0;
    for (std::string line; std::getline(text, line);) count += line.find(words) != std::string::npos;
    return count;
  };
  EXPECT_EQ(lines("submap 1 begins at"), 1) << outcome_.output;
  EXPECT_EQ(lines("lost at 4.") + lines("lost at 5."), 1) << "in the turn: " << outcome_.output;
  EXPECT_EQ(lines("; submap 2 begins"), 1) << outcome_.output;
  EXPECT_EQ(lines("window 1"), 1) << outcome_.output;
  EXPECT_EQ(lines("are one map"), 1) << outcome_.output;
  EXPECT_EQ(lines("rumi info"), 4 + lines(" per second")) << outcome_.output;
  EXPECT_EQ(lines("have a pose in the map"), 1) << outcome_.output;
}

TEST_F(ReplayOfALoss, WithoutMergingTheMapIsTheLargestFrontSubmap) {
  const fs::path out = work_->path() / "unmerged";
  const Outcome outcome = replay(sequence_, out, "--set map_server.merge=false");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const auto figures = evaluate(out, sequence_ / "groundtruth.txt");
  EXPECT_GE(figures["submaps"], 3);
  int most = 0;
  for (const auto& submap : figures["per_submap"]) most = std::max(most, submap["frames"].get<int>());
  EXPECT_EQ(figures["tracked_frames"], most);
  EXPECT_LE(figures["tracked_frame_ratio"], 0.6);
  EXPECT_EQ(accepted_links(out), 0);
  for (const char* submap : {"submaps/001.txt", "submaps/002.txt"})
    EXPECT_EQ(read_file(out / submap), read_file(work_->path() / "out" / submap)) << "merging changes no front submap";
}

// The back submap is rebuilt by the replay, and again from the file of the window.
TEST_F(ReplayOfALoss, IsRebuiltAndItsWindowCanBeRebuiltAnywhere) {
  const fs::path out = work_->path() / "out", again = work_->path() / "again";
  const auto run = read_json_file(out / "run.json");
  ASSERT_EQ(run["windows"]["complete"], 1);
  EXPECT_EQ(run["windows"]["rebuilt"], 1);
  ASSERT_TRUE(fs::exists(out / "submaps/b001.txt"));

  const Outcome rebuilt =
      shell("$RUMI/rumi ruminate '" + (out / "windows").string() + "' -q --json -o '" + again.string() + "' --truth '" +
            (sequence_ / "groundtruth.txt").string() + "' 2>/dev/null");
  ASSERT_EQ(rebuilt.exit_code, 0) << rebuilt.output;
  const auto row = nlohmann::json::parse(rebuilt.output, nullptr, /*allow_exceptions=*/false);
  ASSERT_TRUE(row.is_object()) << rebuilt.output;
  EXPECT_GE(row["registered_gap"].get<double>(), 0.9 * row["gap"].get<double>());
  EXPECT_GE(row["shared_before"], 8);
  EXPECT_LE(row["ate_percent"], 5.0);
  const std::string name = row["window"];
  const fs::path uncut = work_->path() / "uncut";
  ASSERT_EQ(replay(sequence_, uncut, "--set map_server.cull_back_keyframes=false").exit_code, 0);
  EXPECT_EQ(read_file(again / (name + ".txt")), read_file(uncut / "submaps/b001.txt"));
  // Post-culling leaves fewer keyframes, but the same frames.
  const auto back = [](const fs::path& folder) {
    return map_server::MapStore::open(folder / "map.db").value().load().value().submaps().begin()->second;
  };
  EXPECT_EQ(back(uncut).submap.kind, SubmapKind::kBack);
  EXPECT_LT(back(out).submap.keyframes.size(), back(uncut).submap.keyframes.size());
  EXPECT_EQ(back(out).submap.frames.size(), back(uncut).submap.frames.size());
  EXPECT_LT(fs::file_size(out / "map.db"), fs::file_size(uncut / "map.db"));
  EXPECT_EQ(evaluate(out, sequence_ / "groundtruth.txt")["tracked_frames"],
            evaluate(uncut, sequence_ / "groundtruth.txt")["tracked_frames"]);
  EXPECT_TRUE(fs::exists(again / (name + ".submap")));

  const Outcome absent = shell("$RUMI/rumi ruminate -q '" + (out / "windows/absent.window").string() + "'");
  EXPECT_EQ(absent.exit_code, 1);
  EXPECT_THAT(absent.output, HasSubstr("absent.window: cannot be opened"));
}

}  // namespace
}  // namespace rumi::tool
