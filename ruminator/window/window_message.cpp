// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/window_message.h"

#include <fmt/format.h>

#include <algorithm>

namespace rumi::ruminator {
namespace {

std::vector<int64_t> utimes(const std::vector<Sample>& samples) {
  std::vector<int64_t> list;
  list.reserve(samples.size());
  for (const Sample& sample : samples) list.push_back(sample.utime_us);
  return list;
}

int32_t keyframes(const std::vector<Sample>& samples) {
  return static_cast<int32_t>(
      std::count_if(samples.begin(), samples.end(), [](const Sample& s) { return s.is_keyframe; }));
}

std::string name_of(int32_t submap) { return submap == kNoSubmap ? "none" : fmt::format("submap {}", submap); }

}  // namespace

window_t to_message(const RuminationWindow& window, int64_t utime_us, int8_t state) {
  window_t message;
  message.utime = utime_us;
  message.session = window.session;
  message.stream = window.stream;
  message.window_id = window.id;
  message.state = state;
  message.reason = window.reason;
  message.submap_before = window.submap_before;
  message.submap_after = window.submap_after;
  message.lost_utime = window.lost_utime_us;
  message.resumed_utime = window.resumed_utime_us;
  message.approach_utime = utimes(window.approach);
  message.napproach = static_cast<int32_t>(message.approach_utime.size());
  message.gap_frames = window.gap_frames;
  message.by_place = window.by_place;
  message.gap_utime = utimes(window.gap);
  message.ngap = static_cast<int32_t>(message.gap_utime.size());
  message.departure_utime = utimes(window.departure);
  message.ndeparture = static_cast<int32_t>(message.departure_utime.size());
  message.shared_keyframes_before = keyframes(window.approach);
  message.shared_keyframes_after = keyframes(window.departure);
  message.progress = 0;
  message.remaining_s = -1;
  return message;
}

std::string describe(const RuminationWindow& window) {
  if (window.by_place) return fmt::format("{} images that look alike", window.gap.size());
  return fmt::format("{} + {} of {} + {} frames between {} and {} ({} + {} keyframes)", window.approach.size(),
                     window.gap.size(), window.gap_frames, window.departure.size(), name_of(window.submap_before),
                     name_of(window.submap_after), keyframes(window.approach), keyframes(window.departure));
}

}  // namespace rumi::ruminator
