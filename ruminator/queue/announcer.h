// SPDX-License-Identifier: BSD-3-Clause
// Announces the progress of the queued windows on RUMI_WINDOW.
#pragma once

#include <algorithm>
#include <cstdint>
#include <list>
#include <string>

#include "bus/transport/bus.h"
#include "lcmtypes/rumi/window_t.hpp"
#include "ruminator/queue/queue_entry.h"

namespace rumi::ruminator {

class Announcer {
 public:
  explicit Announcer(Bus& bus) : bus_(bus) {}

  // Sets the time of the newest frame, which announcements contain.
  void set_frame_time(int64_t utime_us) { frame_utime_us_ = std::max(frame_utime_us_, utime_us); }
  int64_t frame_utime_us() const { return frame_utime_us_; }

  // Announces the entry's state, with the note as the reason; repeat() repeats both.
  void announce(QueueEntry& entry, const std::string& note = {});
  // Announces a state that no entry has: PUBLISHED or FAILED.
  void publish(const QueueEntry& entry, int8_t state, const std::string& reason);
  // Announces each window again once a second, except those that are left for the next start.
  void repeat(std::list<QueueEntry>& entries, int64_t now_us);

 private:
  Bus& bus_;
  int64_t frame_utime_us_ = 0;
};

}  // namespace rumi::ruminator
