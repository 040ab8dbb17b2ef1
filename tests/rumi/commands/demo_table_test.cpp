// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/commands/demo_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rumi::tool {
namespace {

using testing::HasSubstr;
using testing::Not;

WindowRow window(int64_t lost_us, int64_t resumed_us, int gap, int rebuilt) {
  WindowRow row;
  row.window.lost_utime_us = lost_us;
  row.window.resumed_utime_us = resumed_us;
  row.window.gap.resize(static_cast<size_t>(gap));
  row.result.gap = rebuilt;
  row.result.wall_s = 6.04;
  row.ok = true;
  return row;
}

TEST(DemoStory, TellsOfALossThatWasRebuilt) {
  ReplayOutcome whole;
  whole.begin_us = 1'000'000'000;
  whole.windows = {window(1'011'200'000, 1'013'100'000, 34, 33)};
  whole.counts.front_submaps = whole.counts.front_submaps_in_map = 2;
  EXPECT_EQ(demo_story(whole),
            "Tracking was lost at 11.2 s for 1.9 s; of 34 images that were kept of it COLMAP rebuilt 33 in 6.0 s.\n"
            "2 submaps of the front became one map.\n");
}

TEST(DemoStory, DoesNotPraiseWhatFailed) {
  ReplayOutcome whole;
  EXPECT_THAT(demo_story(whole), HasSubstr("never lost"));
  WindowRow failed = window(2'000'000, 3'000'000, 20, 0);
  failed.ok = false;
  failed.result.submap = Error{"colmap: not found"};
  whole.windows = {failed};
  whole.counts.front_submaps = 3;
  whole.counts.front_submaps_in_map = 1;
  const std::string story = demo_story(whole);
  EXPECT_THAT(story, HasSubstr("could not be rebuilt: colmap: not found"));
  EXPECT_THAT(story, HasSubstr("Of 3 submaps of the front the one map has 1."));
  EXPECT_THAT(story, Not(HasSubstr("became one")));
}

TEST(DemoTable, HasBothRunsAndSaysWhatIsNotKnown) {
  MeasuredRun front, whole;
  front.evaluation.run.frames = whole.evaluation.run.frames = 400;
  front.evaluation.run.tracked_frames = 180;
  whole.evaluation.run.tracked_frames = 398;
  whole.evaluation.run.map.ate_rmse_m = 0.0214;
  whole.evaluation.run.true_rate = 0.995;
  whole.outcome.wall_s = 20.25;
  const std::string table = demo_table(front, whole);
  EXPECT_THAT(table, HasSubstr("180 of 400    398 of 400\n"));
  EXPECT_THAT(table, HasSubstr("unknown       0.021 m\n"));
  EXPECT_THAT(table, HasSubstr("unknown        99.5 %\n"));
  EXPECT_THAT(table, HasSubstr("20.2 s\n"));
}

}  // namespace
}  // namespace rumi::tool
