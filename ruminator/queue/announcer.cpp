// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/announcer.h"

#include "base/running/due.h"
#include "ruminator/window/window_message.h"

namespace rumi::ruminator {
namespace {

constexpr int64_t kAnnouncePeriodUs = 1'000'000;

}  // namespace

void Announcer::announce(QueueEntry& entry, const std::string& note) {
  entry.note = note;
  entry.announced_us = bus_.now_us();
  publish(entry, entry.window_state(), note);
}

void Announcer::publish(const QueueEntry& entry, int8_t state, const std::string& reason) {
  window_t message = to_message(entry.window, std::max(frame_utime_us_, entry.window.lost_utime_us), state);
  if (!reason.empty()) message.reason = reason;
  if (const auto* building = entry.as<Building>()) {
    message.progress = static_cast<float>(building->progress.fraction);
    message.remaining_s = static_cast<float>(building->progress.remaining_s);
  } else if (state == window_t::PUBLISHED || state == window_t::MAPPING) {
    message.progress = 1;
  }
  bus_.publish(channels::kWindow, message);
}

void Announcer::repeat(std::list<QueueEntry>& entries, int64_t now_us) {
  for (QueueEntry& entry : entries)
    if (!entry.is<LeftForNextStart>() && is_due(now_us, entry.announced_us, kAnnouncePeriodUs))
      announce(entry, entry.note);
}

}  // namespace rumi::ruminator
