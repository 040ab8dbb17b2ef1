// SPDX-License-Identifier: BSD-3-Clause
// Announces on RUMI_WINDOW how far the windows in the queue are.
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

  // The time of the newest frame, which announcements carry.
  void set_frame_time(int64_t utime_us) { frame_utime_us_ = std::max(frame_utime_us_, utime_us); }
  int64_t frame_utime_us() const { return frame_utime_us_; }

  // Announces the entry's state. repeat() repeats the note, which stands in the message as the reason.
  void announce(QueueEntry& entry, const std::string& note = {});
  // Announces any state: PUBLISHED or FAILED, which no entry has.
  void publish(const QueueEntry& entry, int8_t state, const std::string& reason);
  // Announces again, once a second each, the windows that this process still works on.
  void repeat(std::list<QueueEntry>& entries, int64_t now_us);

 private:
  Bus& bus_;
  int64_t frame_utime_us_ = 0;
};

}  // namespace rumi::ruminator
