// SPDX-License-Identifier: BSD-3-Clause
// What the queue tells of its windows, and how map_server gets their back submaps.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/running/due.h"
#include "base/running/log.h"
#include "bus/wire/why_undecodable.h"
#include "lcmtypes/rumi/submap_update_t.hpp"
#include "ruminator/queue/rebuild_queue.h"
#include "ruminator/window/window_message.h"

namespace rumi::ruminator {
namespace {

constexpr int64_t kAnnouncePeriodUs = 1'000'000;
constexpr int64_t kTellPeriodUs = 5'000'000;  // what is left to do, while somebody waits for it

}  // namespace

bool RebuildQueue::is_sending() const {
  return std::any_of(entries_.begin(), entries_.end(), [](const QueueEntry& e) { return e.is<Sent>(); });
}

void RebuildQueue::deliver(int64_t now_us) {
  if (stopping_ || is_sending()) return;
  const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const QueueEntry& e) { return e.is<Built>() && e.is_due(now_us); });
  if (entry == entries_.end()) return;
  std::vector<uint8_t> submap = entry->as<Built>()->submap;
  std::string problem;
  if (submap.empty()) problem = spool_->read_submap(entry->name, &submap);
  submap_update_t update;
  if (problem.empty() && !Bus::decode(submap, &update))
    problem = fmt::format("its back submap cannot be sent: {}", why_undecodable<submap_update_t>(submap));
  if (problem.empty())
    send(*entry, std::move(submap));
  else
    fail(entry, problem);
}

void RebuildQueue::send(QueueEntry& entry, std::vector<uint8_t> submap) {
  Built built = std::move(*entry.as<Built>());
  entry.state = Sent{std::move(built)};
  if (entry.note.empty()) announce(entry, "built, on its way to map_server");
  sender_.send("", chunk_t::SUBMAP_UPDATE, 0, std::move(submap),
               [this, name = entry.name](const TransferResult& result) { on_delivered(name, result); });
}

void RebuildQueue::on_delivered(JobName name, const TransferResult& result) {
  const auto entry = find(name);
  if (entry == entries_.end()) return;
  delivery_problem_ = result.ok ? "" : result.reason;
  if (!result.ok) return on_refused(*entry, result.reason);
  if (entry->is_claimed())
    if (const std::string error = spool_->complete(name); !error.empty()) log_error("{}", error);
  const std::optional<int64_t> resumed_us = entry->resumed_us;
  log_info("window {}: {}: map_server has it as submap {}{}", name.window_id, entry->result, -name.window_id,
           resumed_us ? fmt::format(", {:.1f} s after tracking resumed",
                                    1e-6 * static_cast<double>(bus_.now_us() - *resumed_us))
                      : "");
  publish(*entry, window_t::PUBLISHED, "");
  ++published_;
  entries_.erase(entry);
}

void RebuildQueue::on_refused(QueueEntry& entry, const std::string& reason) {
  if (entry.note != reason)
    log_warning("window {}: map_server did not take its back submap: {}", entry.window.id, reason);
  Built built = std::move(entry.as<Sent>()->built);
  built.until_us = bus_.now_us() + retry_us();
  entry.state = std::move(built);
  if (finishing_) leave_built(entry);
  announce(entry, reason);
}

void RebuildQueue::leave_built(QueueEntry& entry) {
  if (entry.holds_submap()) log_warning("window {}: its back submap is in no spool and is lost", entry.window.id);
  entry.state = LeftForNextStart{.is_built = true};
}

void RebuildQueue::announce(QueueEntry& entry, const std::string& note) {
  entry.note = note;
  entry.announced_us = bus_.now_us();
  publish(entry, entry.window_state(), note);
}

void RebuildQueue::publish(const QueueEntry& entry, int8_t state, const std::string& reason) {
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

void RebuildQueue::announce_all(int64_t now_us) {
  for (QueueEntry& entry : entries_)
    if (!entry.is<LeftForNextStart>() && is_due(now_us, entry.announced_us, kAnnouncePeriodUs))
      announce(entry, entry.note);
  if (!finishing_ || finished() || !is_due(now_us, last_told_us_, kTellPeriodUs)) return;
  last_told_us_ = now_us;
  log_info("{}", detail());
}

}  // namespace rumi::ruminator
