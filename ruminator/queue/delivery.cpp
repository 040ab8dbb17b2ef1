// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/delivery.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/running/log.h"
#include "base/this_process/process_name.h"
#include "bus/wire/why_undecodable.h"
#include "lcmtypes/rumi/submap_update_t.hpp"

namespace rumi::ruminator {

Delivery::Delivery(Bus& bus, QueuedWindows& windows, double retry_s)
    : bus_(bus),
      windows_(windows),
      retry_us_(static_cast<int64_t>(retry_s * 1e6)),
      sender_(bus, channels::kSubmap, channels::kSubmapAck, unique_process_name("ruminator")) {}

void Delivery::store(QueueEntry& entry, std::vector<uint8_t> submap) {
  if (entry.is_claimed()) {
    const Result<> stored = windows_.spool()->store_submap(entry.name, submap);
    windows_.note_stored(stored, "the back submap is kept in memory");
    if (stored) submap.clear();
  }
  if (InMemory* memory = entry.memory()) memory->job.reset();
  entry.state = Built{.submap = std::move(submap)};
}

void Delivery::send_next(int64_t now_us) {
  QueuedWindows::Entries& entries = windows_.entries();
  if (std::any_of(entries.begin(), entries.end(), [](const QueueEntry& e) { return e.is<Sent>(); })) return;
  const auto entry = std::find_if(entries.begin(), entries.end(),
                                  [&](const QueueEntry& e) { return e.is<Built>() && e.is_due(now_us); });
  if (entry == entries.end()) return;
  Result<std::vector<uint8_t>> submap = message_of(*entry);
  if (submap)
    send(*entry, std::move(*submap));
  else
    windows_.fail(entry, submap.error_text());
}

Result<std::vector<uint8_t>> Delivery::message_of(const QueueEntry& entry) const {
  const Built& built = *entry.as<Built>();
  if (!built.submap.empty()) return built.submap;
  Result<std::vector<uint8_t>> submap = windows_.spool()->read_submap(entry.name);
  submap_update_t update;
  if (submap && !Bus::decode(*submap, &update))
    return Error{fmt::format("its back submap cannot be sent: {}", why_undecodable<submap_update_t>(*submap))};
  return submap;
}

void Delivery::send(QueueEntry& entry, std::vector<uint8_t> submap) {
  Built built = std::move(*entry.as<Built>());
  entry.state = Sent{std::move(built)};
  if (entry.note.empty()) windows_.announcer().announce(entry, "built, on its way to map_server");
  sender_.send("", chunk_t::SUBMAP_UPDATE, 0, std::move(submap),
               [this, name = entry.name](const TransferResult& result) { on_answer(name, result); });
}

void Delivery::on_answer(JobName name, const TransferResult& result) {
  const auto entry = windows_.find(name);
  if (entry == windows_.entries().end()) return;
  problem_ = result.ok ? "" : result.reason;
  if (!result.ok) return on_refused(*entry, result.reason);
  if (entry->is_claimed())
    if (const Result<> completed = windows_.spool()->complete(name); !completed)
      log_error("{}", completed.error_text());
  const std::optional<int64_t> resumed_us = entry->resumed_us;
  log_info("window {}: {}: map_server has it as submap {}{}", name.window_id, entry->result, -name.window_id,
           resumed_us ? fmt::format(", {:.1f} s after tracking resumed",
                                    1e-6 * static_cast<double>(bus_.now_us() - *resumed_us))
                      : "");
  windows_.announcer().publish(*entry, window_t::PUBLISHED, "");
  ++published_;
  windows_.entries().erase(entry);
}

void Delivery::on_refused(QueueEntry& entry, const std::string& reason) {
  if (entry.note != reason)
    log_warning("window {}: map_server did not take its back submap: {}", entry.window.id, reason);
  Built built = std::move(entry.as<Sent>()->built);
  built.until_us = bus_.now_us() + retry_us_;
  entry.state = std::move(built);
  if (finishing_) leave_for_next_start(entry);
  windows_.announcer().announce(entry, reason);
}

void Delivery::finish() {
  finishing_ = true;
  for (QueueEntry& entry : windows_.entries()) {
    Built* const built = entry.as<Built>();
    if (!built) continue;
    built->until_us = 0;
    if (!problem_.empty()) leave_for_next_start(entry);  // the last attempt to send a submap failed
  }
}

void Delivery::leave_for_next_start(QueueEntry& entry) {
  if (entry.holds_submap()) log_warning("window {}: its back submap is in no spool and is lost", entry.window.id);
  entry.state = LeftForNextStart{.is_built = true};
}

}  // namespace rumi::ruminator
