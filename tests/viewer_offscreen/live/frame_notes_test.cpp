// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/live/frame_notes.h"

#include <gtest/gtest.h>

namespace rumi::viewer_offscreen {
namespace {

track_t track(int64_t utime_us, int8_t state, int32_t submap) {
  track_t track{};
  track.utime = utime_us;
  track.session = 1;
  track.state = state;
  track.submap_id = submap;
  return track;
}

TEST(FrameNotes, WhatIsSaidAgain) {
  FrameNotes notes;
  notes.take(track(100, track_t::LOST, kNoSubmap));
  notes.take(track(300, track_t::TRACKING, 1));
  notes.take(track(200, track_t::TRACKING, 1));  // comes late
  notes.take(track(100, track_t::LOST, 1));      // got its pose afterwards
  ASSERT_EQ(notes.by_time().size(), 3u);
  EXPECT_EQ(notes.by_time()[0].submap.id, kNoSubmap) << "as it came";
  EXPECT_EQ(notes.by_time()[1].utime_us, 200);
  notes.take(track(300, track_t::RECENTLY_LOST, kNoSubmap));  // its pose is withdrawn
  EXPECT_EQ(notes.by_time()[2].state, track_t::RECENTLY_LOST);
  EXPECT_EQ(notes.by_time()[2].submap.id, kNoSubmap);
}

TEST(FrameNotes, TheOldestGoWhereThereAreTooMany) {
  FrameNotes notes(80);
  for (int i = 0; i < 1000; ++i) {
    notes.take(track(i, track_t::TRACKING, 1));
    ASSERT_LE(notes.by_time().size(), 91u);
  }
  EXPECT_GE(notes.by_time().size(), 80u);
  EXPECT_EQ(notes.by_time().back().utime_us, 999);
}

}  // namespace
}  // namespace rumi::viewer_offscreen
