// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/answers.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "base/running/log.h"
#include "base/this_process/process_name.h"
#include "bus/wire/submap_update.h"
#include "map_server/map_messages.h"

namespace rumi::map_server {
namespace {

constexpr int kMostPending = 64;  // most answers that are being sent at a time, refusals included

}  // namespace

Answers::Answers(Bus& bus, const Atlas& atlas)
    : bus_(bus),
      atlas_(atlas),
      sender_(bus, channels::kMapChunk, channels::kMapAck, unique_process_name("map_server")) {}

void Answers::answer(const map_request_t& request) {
  if (large_ >= kMost) return refuse(request, "busy with other requests; ask again later");
  try {
    switch (request.what) {
      case map_request_t::SUBMAP:
        return answer_submap(request);
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
  } catch (const std::length_error& error) {  // thrown by encode_message()
    refuse(request, fmt::format("{}; a REGION of a smaller radius may do", error.what()));
  }
}

const AtlasSubmap* Answers::find_or_refuse(const map_request_t& request) {
  const AtlasSubmap* owner = atlas_.find({request.session, request.submap_id});
  if (!owner)
    refuse(request, fmt::format("no submap {} of session {} here; RUMI_MAP_STATUS lists the {} there are",
                                request.submap_id, request.session, atlas_.submaps().size()));
  return owner;
}

void Answers::answer_submap(const map_request_t& request) {
  const AtlasSubmap* owner = find_or_refuse(request);
  if (!owner) return;
  if (request.base_revision < 0 || request.base_revision > owner->submap.revision)
    return refuse(request, fmt::format("base_revision {} of submap {}: it is at revision {}", request.base_revision,
                                       request.submap_id, owner->submap.revision));
  send(request, chunk_t::SUBMAP_UPDATE, encode_message(make_submap_update(owner->submap, request.base_revision)));
}

void Answers::answer_placed_submap(const map_request_t& request) {
  const AtlasSubmap* owner = find_or_refuse(request);
  if (!owner) return;
  if (!owner->in_map)
    return refuse(request,
                  fmt::format("submap {} of session {} is not part of the map", request.submap_id, request.session));
  send(request, chunk_t::SUBMAP_UPDATE, encode_message(make_submap_update(place(owner->submap, owner->placement), 0)));
}

void Answers::answer_region(const map_request_t& request) {
  const Eigen::Vector3d center(request.center);
  if (!center.allFinite() || !std::isfinite(request.radius) || request.radius <= 0)
    return refuse(request, fmt::format("a region of radius {} about {}, {}, {} is none", request.radius, center.x(),
                                       center.y(), center.z()));
  send(request, chunk_t::REGION, encode_message(make_map_region(atlas_, center, request.radius, bus_.now_us())));
}

void Answers::send(const map_request_t& request, int8_t kind, std::vector<uint8_t> payload,
                   std::optional<int64_t> checksum) {
  const std::pair<std::string, int32_t> id{request.requester, request.request_id};
  const bool is_large = kind != chunk_t::REFUSED;
  under_way_.insert(id);
  large_ += is_large;
  const auto done = [this, id, is_large](const TransferResult& result) {
    under_way_.erase(id);
    large_ -= is_large;
    if (!result.ok) log_warning("the answer to {} did not arrive: {}", id.first, result.reason);
  };
  sender_.send(request.requester, kind, request.request_id, std::move(payload), done, checksum);
}

void Answers::refuse(const map_request_t& request, const std::string& why) {
  ++refused_;
  if (sender_.pending() >= kMostPending) return;
  send(request, chunk_t::REFUSED, {why.begin(), why.end()});
}

bool Answers::is_under_way(const map_request_t& request) const {
  return under_way_.contains({request.requester, request.request_id});
}

}  // namespace rumi::map_server
