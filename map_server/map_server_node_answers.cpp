// SPDX-License-Identifier: BSD-3-Clause
// What map_server answers to RUMI_MAP_REQUEST.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/running/is_ready.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "bus/wire/submap_update.h"
#include "map_server/map_messages.h"
#include "map_server/map_server_node.h"

namespace rumi::map_server {
namespace {

constexpr int kMaxAnswers = 4;        // large ones under way, and snapshots waited for; more are refused
constexpr int kMaxSmallAnswers = 64;  // refusals under way; further requests go unanswered and are repeated by who asks

}  // namespace

void MapServerNode::on_request(const map_request_t& request) {
  const StageClock clock("map_server.answer");
  if (request.requester.empty()) {
    ++rejected_;
    return;
  }
  // Who hears nothing asks again; the answer is on its way already.
  if (answering_.contains({request.requester, request.request_id})) return;
  if (request.what == map_request_t::STATUS) return tell_all();
  // A snapshot waits for its turn: who shows a large map asks for one submap after the other, and would leave it none.
  if (request.what != map_request_t::SNAPSHOT && large_answers_ >= kMaxAnswers)
    return refuse(request, "busy with other requests; ask again later");
  try {
    answer(request);
  } catch (const std::length_error& error) {
    refuse(request, fmt::format("{}; a REGION of a smaller radius may do", error.what()));
  }
}

void MapServerNode::answer(const map_request_t& request) {
  switch (request.what) {
    case map_request_t::SUBMAP:
      return answer_submap(request);
    case map_request_t::SNAPSHOT:
      return wait_for_merge(request);
    case map_request_t::PLACED_SUBMAP:
      return answer_placed_submap(request);
    case map_request_t::TRAJECTORY:
      return send(request, chunk_t::TRAJECTORY, encode_message(make_trajectory(atlas_, bus_.now_us())));
    case map_request_t::REGION:
      return answer_region(request);
    default:
      return refuse(request, fmt::format("what = {}: this map_server knows 0 (submap), 1 (snapshot), 2 (status), 3 "
                                         "(placed submap), 4 (trajectory), 5 (region)",
                                         static_cast<int>(request.what)));
  }
}

const AtlasSubmap* MapServerNode::asked_for(const map_request_t& request) {
  const AtlasSubmap* owner = atlas_.find({request.session, request.submap_id});
  if (!owner)
    refuse(request, fmt::format("no submap {} of session {} here; RUMI_MAP_STATUS lists the {} there are",
                                request.submap_id, request.session, atlas_.submaps().size()));
  return owner;
}

bool MapServerNode::waits(const map_request_t& request) const {
  const auto same = [&](const map_request_t& w) {
    return w.requester == request.requester && w.request_id == request.request_id;
  };
  return (copying_for_ && same(*copying_for_)) || std::any_of(waiting_.begin(), waiting_.end(), same) ||
         std::any_of(merged_.begin(), merged_.end(), same);
}

// A snapshot shows all that was heard so far as one map.
void MapServerNode::wait_for_merge(const map_request_t& request) {
  if (waits(request)) return;
  constexpr int64_t kMost = TransferOptions().max_payload_bytes;
  if (store_.bytes() > kMost)
    return refuse(request, fmt::format("the database has {} bytes, at most {} are sent; copy its file instead, or what "
                                       "map_server.snapshot_s makes",
                                       store_.bytes(), kMost));
  if (static_cast<int>(waiting_.size() + merged_.size()) >= kMaxAnswers)
    return refuse(request, "busy with other requests; ask again later");
  merger_.hurry();
  waiting_.push_back(request);
  merge(bus_.now_us());
}

void MapServerNode::answer_submap(const map_request_t& request) {
  const AtlasSubmap* owner = asked_for(request);
  if (!owner) return;
  if (request.base_revision < 0 || request.base_revision > owner->submap.revision)
    return refuse(request, fmt::format("base_revision {} of submap {}: it is at revision {}", request.base_revision,
                                       request.submap_id, owner->submap.revision));
  send(request, chunk_t::SUBMAP_UPDATE, encode_message(make_submap_update(owner->submap, request.base_revision)));
}

void MapServerNode::answer_placed_submap(const map_request_t& request) {
  const AtlasSubmap* owner = asked_for(request);
  if (!owner) return;
  if (!owner->in_map)
    return refuse(request,
                  fmt::format("submap {} of session {} is not part of the map", request.submap_id, request.session));
  send(request, chunk_t::SUBMAP_UPDATE, encode_message(make_submap_update(place(owner->submap, owner->placement), 0)));
}

void MapServerNode::answer_region(const map_request_t& request) {
  const Eigen::Vector3d center(request.center);
  if (!center.allFinite() || !std::isfinite(request.radius) || request.radius <= 0)
    return refuse(request, fmt::format("a region of radius {} about {}, {}, {} is none", request.radius, center.x(),
                                       center.y(), center.z()));
  send(request, chunk_t::REGION, encode_message(make_map_region(atlas_, center, request.radius, bus_.now_us())));
}

// One after the other: a copy may be large. There is room for one beside the most of all other answers.
void MapServerNode::begin_answer_with_snapshot() {
  while (!copying_for_ && !merged_.empty() && large_answers_ <= kMaxAnswers) {
    // Of everything heard so far, frame states included.
    const std::string problem = save();
    if (problem.empty() && store_.is_behind()) return;
    const map_request_t request = merged_.front();
    merged_.erase(merged_.begin());
    if (!problem.empty()) {
      refuse(request, problem);
      continue;
    }
    copying_for_ = request;
    copy_ = store_.begin_copy_bytes(options_.merge.thread);
    answer_with_snapshot();
  }
}

void MapServerNode::answer_with_snapshot() {
  if (!is_ready(copy_)) return;
  const StageClock clock("map_server.answer");
  DatabaseBytes copy = copy_.get();
  const map_request_t request = *std::exchange(copying_for_, std::nullopt);
  if (!copy.error.empty()) return refuse(request, copy.error);
  send(request, chunk_t::DATABASE, std::move(copy.bytes), copy.checksum);
}

void MapServerNode::send(const map_request_t& request, int8_t kind, std::vector<uint8_t> payload,
                         std::optional<int64_t> checksum) {
  const std::pair<std::string, int32_t> id{request.requester, request.request_id};
  const bool is_large = kind != chunk_t::REFUSED;
  answering_.insert(id);
  large_answers_ += is_large;
  const auto done = [this, id, is_large](const TransferResult& result) {
    answering_.erase(id);
    large_answers_ -= is_large;
    if (!result.ok) log_warning("the answer to {} did not arrive: {}", id.first, result.reason);
  };
  sender_.send(request.requester, kind, request.request_id, std::move(payload), done, checksum);
}

void MapServerNode::refuse(const map_request_t& request, const std::string& why) {
  ++refused_;
  if (sender_.pending() >= kMaxSmallAnswers) return;
  send(request, chunk_t::REFUSED, {why.begin(), why.end()});
}

}  // namespace rumi::map_server
