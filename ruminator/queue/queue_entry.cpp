// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/queue_entry.h"

#include "lcmtypes/rumi/window_t.hpp"

namespace rumi::ruminator {
namespace {

// True if `until_us` has passed, or is more than an hour away: then the clock was set back, and the window would wait
// too long.
bool has_come(int64_t until_us, int64_t now_us) {
  constexpr int64_t kClockWentBackUs = 3'600'000'000;
  return now_us >= until_us || until_us - now_us > kClockWentBackUs;
}

}  // namespace

int8_t window_state(BuildStage stage) {
  switch (stage) {
    case BuildStage::kExtracting:
      return window_t::EXTRACTING;
    case BuildStage::kMatching:
      return window_t::MATCHING;
    case BuildStage::kMapping:
      return window_t::MAPPING;
  }
  return window_t::MAPPING;
}

int8_t QueueEntry::window_state() const {
  if (const auto* building = as<Building>()) return ruminator::window_state(building->progress.stage);
  if (const auto* left = as<LeftForNextStart>()) return left->is_built ? window_t::MAPPING : window_t::QUEUED;
  return is<Waiting>() ? window_t::QUEUED : window_t::MAPPING;
}

bool QueueEntry::is_claimed() const {
  const auto* spooled = std::get_if<InSpool>(&place);
  return spooled && spooled->claim;
}

bool QueueEntry::is_due(int64_t now_us) const {
  if (const auto* waiting = as<Waiting>()) return has_come(waiting->until_us, now_us);
  if (const auto* built = as<Built>()) return has_come(built->until_us, now_us);
  return false;
}

int64_t QueueEntry::image_bytes() const {
  if (!memory() || !memory()->job) return 0;
  int64_t bytes = 0;
  for (const image_t& image : memory()->job->images) bytes += static_cast<int64_t>(image.data.size());
  return bytes;
}

bool QueueEntry::holds_submap() const {
  if (const auto* built = as<Built>()) return !built->submap.empty();
  if (const auto* sent = as<Sent>()) return !sent->built.submap.empty();
  return false;
}

}  // namespace rumi::ruminator
