// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/back_submap_fetcher.h"

#include <fmt/format.h>

#include "base/running/log.h"
#include "bus/wire/submap_update.h"
#include "lcmtypes/rumi/map_request_t.hpp"

namespace rumi::front_tracker {
namespace {

constexpr int64_t kAskAgainUs = 2'000'000;  // time after which a request without an answer is repeated
// Room for one submap: some three thousand keyframes of a thousand keypoints.
constexpr TransferOptions kTransfer{.max_held_bytes = int64_t{128} << 20};

}  // namespace

BackSubmapFetcher::BackSubmapFetcher(Bus& bus, const std::string& process_name, int max_keyframes, Handlers handlers)
    : bus_(bus),
      name_(process_name),
      max_keyframes_(max_keyframes),
      handlers_(std::move(handlers)),
      receiver_(
          bus, channels::kMapChunk, channels::kMapAck, process_name, false,
          [this](const ChunkReceiver::Payload& payload) { return on_payload(payload); }, kTransfer) {}

void BackSubmapFetcher::begin_session(int64_t session) {
  session_ = session;
  listed_.clear();
  settled_.clear();
  asked_for_ = kNoSubmap;
}

void BackSubmapFetcher::on_map(const MapOverview& map) {
  listed_.clear();
  for (const auto& [key, s] : map.submaps()) {
    const bool is_ours = s.session == session_ && s.submap_id < 0 && s.kind == static_cast<int8_t>(SubmapKind::kBack);
    if (!is_ours || !s.in_map || !s.closed) continue;
    listed_[s.submap_id] = s.revision;
    if (s.keyframes <= max_keyframes_ || settled_.contains(s.submap_id)) continue;
    settled_[s.submap_id] = s.revision;
    refuse(fmt::format("back submap {}: it has {} keyframes, {} are kept at most", s.submap_id, s.keyframes,
                       max_keyframes_));
  }
  std::erase_if(settled_, [this](const auto& settled) {
    if (listed_.contains(settled.first)) return false;
    handlers_.forget(settled.first);
    return true;
  });
  ask(bus_.now_us());
}

void BackSubmapFetcher::tick(int64_t now_us) {
  receiver_.tick(now_us);
  const bool waited = is_due(now_us, asked_us_, kAskAgainUs);
  if (waited && asked_for_ != kNoSubmap && !receiver_.progress(last_request_)) asked_for_ = kNoSubmap;
  if (waited) ask(now_us);
}

// Requests one submap at a time, the oldest first (ids count down).
void BackSubmapFetcher::ask(int64_t now_us) {
  if (asked_for_ != kNoSubmap) return;
  for (auto it = listed_.rbegin(); it != listed_.rend(); ++it) {
    const auto& [id, revision] = *it;
    if (const auto settled = settled_.find(id); settled != settled_.end() && settled->second >= revision) continue;
    asked_for_ = id;
    asked_us_ = now_us;
    map_request_t request{};
    request.utime = now_us;
    request.requester = name_;
    request.request_id = ++last_request_;
    request.what = map_request_t::SUBMAP;
    request.session = session_;
    request.submap_id = id;
    bus_.publish(channels::kMapRequest, request);
    return;
  }
}

ChunkReceiver::Verdict BackSubmapFetcher::on_payload(const ChunkReceiver::Payload& payload) {
  if (asked_for_ == kNoSubmap || payload.request_id != last_request_) return {.ok = false, .reason = "not asked for"};
  if (payload.kind != chunk_t::SUBMAP_UPDATE) {  // map_server cannot answer now and is asked again later
    asked_for_ = kNoSubmap;
    return {};
  }
  const int id = std::exchange(asked_for_, kNoSubmap);
  if (!listed_.contains(id)) return {};  // no longer part of the map
  settled_[id] = listed_.at(id);
  const Result<> taken = take(id, payload.bytes);
  if (!taken) refuse(taken.error_text());
  ask(bus_.now_us());
  return {.ok = taken.has_value(), .reason = taken.error_text()};
}

Result<> BackSubmapFetcher::take(int id, std::span<const uint8_t> bytes) {
  submap_update_t update;
  if (!Bus::decode(bytes, &update))
    return Error{fmt::format("back submap {}: {} bytes that are no submap update", id, bytes.size())};
  if (update.session != session_ || update.submap_id != id)
    return Error{
        fmt::format("back submap {}: submap {} of session {} came instead", id, update.submap_id, update.session)};
  Submap submap;
  if (Result<> applied = apply_submap_update(update, &submap); !applied) return applied;
  return handlers_.take(std::move(submap));
}

void BackSubmapFetcher::refuse(const std::string& why) {
  ++refused_;
  problem_ = why;
  log_warning("not used for relocalization: {}", why);
}

}  // namespace rumi::front_tracker
