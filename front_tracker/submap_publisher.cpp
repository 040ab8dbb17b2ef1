// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/submap_publisher.h"

#include <cmath>

#include "base/running/due.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "bus/wire/submap_update.h"

namespace rumi::front_tracker {

SubmapPublisher::SubmapPublisher(Bus& bus, const std::string& sender_name, double interval_s)
    : sender_(bus, channels::kSubmap, channels::kSubmapAck, sender_name), interval_s_(interval_s) {}

void SubmapPublisher::publish(Tracker& tracker, int64_t now_us, bool all) {
  const StageClock clock("front_tracker.send");
  tracker.visit_submaps([&](FrontSubmap& submap) {
    Progress& progress = progress_[submap.map.key];
    if (progress.in_flight) return;
    if (all) submap.close();
    if (submap.map.revision <= progress.stored_revision) return;
    if (!all && !is_due(now_us, progress.last_sent_us, std::llround(1e6 * interval_s_))) return;
    progress.last_sent_us = now_us;
    send(submap, &progress);
  });
}

bool SubmapPublisher::complete(Tracker& tracker) const {
  bool complete = true;
  tracker.visit_submaps([&](const FrontSubmap& submap) {
    const auto progress = progress_.find(submap.map.key);
    complete = complete && submap.map.closed && progress != progress_.end() && !progress->second.in_flight &&
               submap.map.revision <= progress->second.stored_revision;
  });
  return complete;
}

void SubmapPublisher::send(FrontSubmap& submap, Progress* progress) {
  const submap_update_t update = make_submap_update(submap.map, progress->stored_revision);
  submap.map.hand_out();
  progress->in_flight = true;
  sender_.send("", chunk_t::SUBMAP_UPDATE, 0, encode_message(update), [this, progress](const TransferResult& result) {
    progress->in_flight = false;
    // If the server rejects an update, it says which revision it has stored. The next update begins there.
    if (result.ok || result.revision < progress->stored_revision) progress->stored_revision = result.revision;
    const std::string failure = result.ok ? "" : result.reason;
    if (failure_ != failure && !failure.empty()) log_warning("map_server did not take a submap update: {}", failure);
    failure_ = failure;
  });
}

}  // namespace rumi::front_tracker
