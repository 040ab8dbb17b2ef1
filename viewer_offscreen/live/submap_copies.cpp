// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/live/submap_copies.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "base/running/due.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "bus/wire/pose.h"
#include "bus/wire/submap_update.h"
#include "lcmtypes/rumi/map_request_t.hpp"

namespace rumi::viewer_offscreen {
namespace {

constexpr int64_t kAskAgainUs = 2'000'000;  // time after which a request without an answer is repeated

// Forgets the descriptors and undistorted pixels, which are most of a keyframe's memory.
void keep_what_is_drawn(Submap* submap) {
  for (auto& [id, keyframe] : submap->keyframes) {
    if (keyframe.features->descriptors.empty()) continue;
    auto features = std::make_shared<Features>();
    features->keypoints = keyframe.features->keypoints;
    keyframe.features = std::move(features);
  }
}

}  // namespace

SubmapCopies::SubmapCopies(Bus& bus, const std::string& requester, std::function<void()> changed)
    : bus_(bus),
      requester_(requester),
      changed_(std::move(changed)),
      receiver_(bus, channels::kMapChunk, channels::kMapAck, requester, false,
                [this](const ChunkReceiver::Payload& payload) { return on_payload(payload); },
                {.max_held_bytes = kMaxMessageBytes}) {}

bool SubmapCopies::take(const map_status_t& status) {
  if (!map_states_.take(status.utime, bus_.now_us())) return false;
  map_.take(status);
  std::map<SubmapKey, Copy> listed;
  for (const auto& [key, summary] : map_.submaps()) {
    if (const auto known = copies_.find(key); known != copies_.end()) listed[key] = std::move(known->second);
    listed[key].summary = summary;
  }
  copies_ = std::move(listed);  // drops the copies of submaps that no longer exist
  changed_();
  return true;
}

ChunkReceiver::Verdict SubmapCopies::on_payload(const ChunkReceiver::Payload& payload) {
  const StageClock clock("viewer_offscreen.receive");
  Copy* copy = nullptr;
  for (auto& [key, candidate] : copies_)
    if (candidate.request_id == payload.request_id && payload.request_id != 0) copy = &candidate;
  if (!copy) return {.ok = false, .reason = "not asked for"};
  copy->request_id = 0;
  submap_update_t update;
  if (payload.kind != chunk_t::SUBMAP_UPDATE) return {};  // a refusal: the request is repeated later
  std::string reason = "not a submap update";
  if (Bus::decode(payload.bytes, &update)) {
    if (update.base_revision == 0) copy->submap = Submap();
    reason = apply_submap_update(update, &copy->submap).error_text();
    keep_what_is_drawn(&copy->submap);
    copy->placement_revision = copy->asked_placement_revision;
  }
  if (!reason.empty()) {
    copy->submap = Submap();  // the update does not fit, so the copy begins afresh
    log_warning("submap {} from {} is rejected: {}", copy->summary.submap_id, payload.sender, reason);
  }
  ++copy->taken;
  changed_();
  return {.ok = reason.empty(), .reason = reason, .revision = copy->submap.revision};
}

bool SubmapCopies::is_time_to_ask(const Copy& copy, int64_t now_us, int64_t whole_pause_us) const {
  if (copy.asked_us == 0) return true;
  if (copy.request_id != 0)
    return !receiver_.progress(copy.request_id).has_value() && is_due(now_us, copy.asked_us, kAskAgainUs);
  const int64_t pause_us = copy.wanted_placement_revision() != 0 ? whole_pause_us : 0;
  return is_due(now_us, copy.asked_us, std::max(pause_us, kAskAgainUs / 4));
}

void SubmapCopies::request_missing(int64_t now_us, int64_t whole_pause_us) {
  for (auto& [key, copy] : copies_) {
    if (copy.up_to_date() || !is_time_to_ask(copy, now_us, whole_pause_us)) continue;
    copy.asked_placement_revision = copy.wanted_placement_revision();
    const bool is_placed = copy.asked_placement_revision != 0;
    map_request_t request{};
    request.utime = now_us;
    request.requester = requester_;
    request.request_id = ++last_request_;
    request.what = is_placed ? map_request_t::PLACED_SUBMAP : map_request_t::SUBMAP;
    request.session = key.session;
    request.submap_id = key.id;
    request.base_revision = is_placed || copy.placement_revision != 0 ? 0 : copy.submap.revision;
    copy.request_id = request.request_id;
    copy.asked_us = now_us;
    bus_.publish(channels::kMapRequest, request);
  }
}

bool SubmapCopies::complete() const {
  return std::all_of(copies_.begin(), copies_.end(), [](const auto& entry) { return entry.second.up_to_date(); });
}

MapPicture SubmapCopies::picture() const {
  MapPicture picture;
  for (const auto& [key, copy] : copies_) picture.submaps.push_back({&copy.submap, copy.can_be_shown_in_map()});
  for (const auto& [number, link] : map_.links())
    picture.links.push_back({{link.session_a, link.submap_a},
                             {link.session_b, link.submap_b},
                             link.kind == link_t::SAME_IMAGES,
                             link.accepted != 0});
  return picture;
}

std::optional<SE3> SubmapCopies::map_from_cam(const track_t& track) const {
  const auto copy = copies_.find({track.session, track.submap_id});
  if (copy == copies_.end() || !copy->second.summary.in_map) return std::nullopt;
  const std::optional<Sim3> map_from_submap = from_wire(copy->second.summary.map_from_submap);
  const std::optional<SE3> cam_from_submap = from_wire(track.cam_from_submap);
  if (!map_from_submap || !cam_from_submap) return std::nullopt;
  return map_from_submap->transform_camera(*cam_from_submap).inverse();
}

}  // namespace rumi::viewer_offscreen
