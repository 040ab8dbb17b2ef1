// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/scene/timeline.h"

#include <algorithm>

namespace rumi::viewer_offscreen {
namespace {

void extend(std::vector<TimelineSpan>* spans, int64_t utime_us, int8_t state, int submap) {
  if (spans->empty() || spans->back().state != state || spans->back().submap != submap)
    spans->push_back({utime_us, utime_us, state, submap});
  spans->back().last_us = utime_us;
}

// Ends each span where the next one begins, so that no gap of a frame's length lies between them.
void close_gaps(std::vector<TimelineSpan>* spans, int64_t end_us) {
  for (size_t i = 0; i < spans->size(); ++i)
    (*spans)[i].last_us = i + 1 < spans->size() ? (*spans)[i + 1].first_us : end_us;
}

int64_t median_period_us(const std::vector<FrameNote>& frames) {
  if (frames.size() < 2) return 0;
  std::vector<int64_t> periods;
  for (size_t i = 1; i < frames.size(); ++i) periods.push_back(frames[i].utime_us - frames[i - 1].utime_us);
  const auto middle = periods.begin() + static_cast<ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  return *middle;
}

}  // namespace

Timeline make_timeline(const std::vector<FrameNote>& frames, const std::vector<int>& tracked_in,
                       const std::vector<int>& placed_in) {
  Timeline timeline;
  if (frames.empty()) return timeline;
  for (size_t i = 0; i < frames.size(); ++i) {
    extend(&timeline.tracked, frames[i].utime_us, frames[i].state, tracked_in[i]);
    extend(&timeline.in_map, frames[i].utime_us, FrameNote::kUnknownState, placed_in[i]);
  }
  timeline.end_us = frames.back().utime_us + median_period_us(frames);
  close_gaps(&timeline.tracked, timeline.end_us);
  close_gaps(&timeline.in_map, timeline.end_us);
  return timeline;
}

std::vector<LostSpan> find_lost(const std::vector<FrameNote>& frames, const std::vector<bool>& posed) {
  std::vector<LostSpan> spans;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (posed[i]) continue;
    if (i == 0 || posed[i - 1]) spans.push_back({frames[i].utime_us, frames[i].utime_us, 0});
    spans.back().last_us = frames[i].utime_us;
    ++spans.back().frames;
  }
  return spans;
}

}  // namespace rumi::viewer_offscreen
