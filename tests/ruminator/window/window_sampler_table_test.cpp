// SPDX-License-Identifier: BSD-3-Clause
// Tests every line of the table in window_sampler.h.
#include <gmock/gmock.h>

#include <functional>

#include "tests/ruminator/window_feed.h"

namespace rumi::ruminator {
namespace {

using Phase = WindowSampler::Phase;

struct Line {
  const char* name;
  Phase from;
  std::function<void(WindowFeed&)> what_comes;
  Phase to;
  int complete;   // number of windows that ended
  int window_id;  // the window that is open then; 0: none
};

void PrintTo(const Line& line, std::ostream* out) { *out << line.name; }

// Feeds frames until the phase is reached: submap 1 tracked, then lost, then submap 2 tracked for three frames with one
// keyframe.
WindowFeed in(Phase phase) {
  WindowFeed feed({.stride = 5, .window_length = 4, .shared_keyframes = 3, .departure_min_keyframes = 2});
  feed.span(50, 1, 10);
  if (phase != Phase::kWatching) feed.span(5, kNoSubmap);
  if (phase == Phase::kDeparture) feed.span(3, 2, 10);
  return feed;
}

const auto frames = [](int count, int32_t submap, int keyframe_every = 100) {
  return [=](WindowFeed& feed) { feed.span(count, submap, keyframe_every); };
};

const Line kLines[] = {
    {"watching, tracked", Phase::kWatching, frames(9, 1), Phase::kWatching, 0, 0},
    {"watching, another submap", Phase::kWatching, frames(1, 2), Phase::kWatching, 0, 0},
    {"watching, lost", Phase::kWatching, frames(1, kNoSubmap), Phase::kGap, 0, 1},
    {"watching, withdrawn", Phase::kWatching, [](WindowFeed& f) { f.withdraw(45, 50); }, Phase::kGap, 0, 1},
    {"gap, still lost", Phase::kGap, frames(100, kNoSubmap), Phase::kGap, 0, 1},
    {"gap, tracked", Phase::kGap, frames(1, 2), Phase::kDeparture, 0, 1},
    {"gap, some poses afterwards", Phase::kGap,
     [](WindowFeed& f) {
       f.late_pose(55, 2);
       f.span(1, 2);
     },
     Phase::kDeparture, 0, 1},
    {"gap, all poses afterwards", Phase::kGap,
     [](WindowFeed& f) {
       for (int utime = 51; utime <= 55; ++utime) f.late_pose(utime, 1);
       f.span(1, 1);
     },
     Phase::kWatching, 0, 0},
    {"departure, few samples", Phase::kDeparture, frames(5, 2), Phase::kDeparture, 0, 1},
    {"departure, enough keyframes", Phase::kDeparture, frames(9, 2, 4), Phase::kWatching, 1, 0},
    {"departure, a camera that stands still", Phase::kDeparture, frames(200, 2), Phase::kWatching, 1, 0},
    {"departure, another known submap", Phase::kDeparture, frames(1, 1), Phase::kWatching, 1, 0},
    {"departure, a new submap that goes on", Phase::kDeparture, frames(1, 3), Phase::kDeparture, 0, 1},
    {"departure, died young", Phase::kDeparture, frames(1, kNoSubmap), Phase::kGap, 0, 1},
    {"departure, lost with enough", Phase::kDeparture,
     [](WindowFeed& f) {
       f.span(1, 2, 1);
       f.span(1, kNoSubmap);
     },
     Phase::kGap, 1, 2},
    {"departure, withdrawn", Phase::kDeparture, [](WindowFeed& f) { f.withdraw(56, 58); }, Phase::kGap, 0, 1},
    {"departure, the end", Phase::kDeparture, [](WindowFeed& f) { f.finish(); }, Phase::kWatching, 1, 0},
    {"gap, another session", Phase::kGap,
     [](WindowFeed& f) {
       ++f.session;
       f.span(1, 1);
     },
     Phase::kWatching, 1, 0},
};

class WindowSamplerTable : public ::testing::TestWithParam<Line> {};

TEST_P(WindowSamplerTable, Holds) {
  const Line& line = GetParam();
  WindowFeed feed = in(line.from);
  ASSERT_EQ(feed.sampler.phase(), line.from);
  line.what_comes(feed);
  EXPECT_EQ(feed.sampler.phase(), line.to);
  EXPECT_EQ(feed.windows.size(), line.complete);
  EXPECT_EQ(feed.sampler.open() ? feed.sampler.open()->id : 0, line.window_id);
  EXPECT_TRUE(line.to == Phase::kWatching || feed.sampler.is_settled());
}

INSTANTIATE_TEST_SUITE_P(All, WindowSamplerTable, ::testing::ValuesIn(kLines));

}  // namespace
}  // namespace rumi::ruminator
