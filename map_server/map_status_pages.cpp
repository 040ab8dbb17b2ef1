// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/map_status_pages.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include "bus/wire/pose.h"

namespace rumi::map_server {
namespace {

constexpr int64_t kPageBytes = 60'000;  // so that a page fits one LCM datagram
constexpr size_t kMaxDoubtBytes = 200;  // a doubt is cut off there, so that one link cannot fill a page

submap_summary_t summarize(const AtlasSubmap& owner) {
  const Submap& s = owner.submap;
  submap_summary_t summary;
  summary.session = s.key.session;
  summary.submap_id = s.key.id;
  summary.kind = static_cast<int8_t>(s.kind);
  summary.closed = s.closed;
  summary.in_map = owner.in_map;
  summary.revision = s.revision;
  summary.keyframes = static_cast<int32_t>(s.keyframes.size());
  summary.landmarks = static_cast<int32_t>(s.landmarks.size());
  summary.frames = static_cast<int32_t>(s.frames.size());
  summary.stream = s.stream;
  summary.first_utime = s.frames.empty() ? 0 : s.frames.begin()->first;
  summary.last_utime = s.frames.empty() ? 0 : s.frames.rbegin()->first;
  summary.placement_revision = owner.placement.revision;
  summary.map_from_submap = to_wire(owner.placement.latest());
  return summary;
}

link_t to_wire(const Link& link) {
  link_t wire;
  wire.session_a = link.a.session, wire.submap_a = link.a.id;
  wire.session_b = link.b.session, wire.submap_b = link.b.id;
  wire.kind = static_cast<int8_t>(link.kind);
  wire.accepted = link.accepted();
  wire.keyframes = link.keyframes, wire.keyframe_inliers = link.keyframe_inliers;
  wire.landmarks = link.landmarks, wire.landmark_inliers = link.landmark_inliers;
  wire.rmse_px = link.rmse_px;
  wire.doubt = link.doubt.substr(0, kMaxDoubtBytes);
  return wire;
}

int64_t wire_bytes(const Link& link) {
  static const int64_t without_doubt = link_t()._getEncodedSizeNoHash();
  return without_doubt + static_cast<int64_t>(std::min(link.doubt.size(), kMaxDoubtBytes));
}

map_status_t counts(const Atlas& atlas, int64_t utime_us) {
  map_status_t message{};
  message.utime = utime_us;
  message.map_revision = atlas.revision();
  message.frames = static_cast<int64_t>(atlas.frames().size());
  const Atlas::FrameCounts frames = atlas.count_frames();
  message.frames_in_map = frames.present_in_map + frames.earlier_in_map;
  message.earlier_frames = frames.earlier;
  message.localized_frames = frames.is_joined ? frames.present_in_map : 0;
  for (const auto& [key, owner] : atlas.submaps()) {
    ++(owner.submap.kind == SubmapKind::kFront ? message.front_submaps : message.back_submaps);
    message.submaps_in_map += owner.in_map;
    message.keyframes += static_cast<int64_t>(owner.submap.keyframes.size());
    message.landmarks += static_cast<int64_t>(owner.submap.landmarks.size());
  }
  message.links_in_all = static_cast<int32_t>(atlas.links().size());
  for (const Link& link : atlas.links()) message.links_accepted += link.accepted();
  return message;
}

}  // namespace

map_status_t MapStatusPages::next(const Atlas& atlas, int64_t utime_us) {
  map_status_t page = counts(atlas, utime_us);
  ++page_;
  const int64_t room = kPageBytes - page.getEncodedSize();
  int64_t links_bytes = 0;
  for (const Link& link : atlas.links()) links_bytes += wire_bytes(link);
  static const int64_t submap_bytes = submap_summary_t()._getEncodedSizeNoHash();
  const int64_t most = (room - std::min(links_bytes, room / 2)) / submap_bytes;
  for (const SubmapKey& key : choose_submaps(atlas, static_cast<size_t>(most))) {
    const AtlasSubmap& owner = *atlas.find(key);
    page.submaps.push_back(summarize(owner));
    told_[key] = {page_, owner.submap.revision, owner.placement.revision, owner.in_map};
  }
  page.nsubmaps = static_cast<int32_t>(page.submaps.size());
  add_links(atlas, room - page.nsubmaps * submap_bytes, &page);
  round_goes_on_ = round_goes_on_ && !all_is_told(atlas);
  return page;
}

bool MapStatusPages::has_changed(const AtlasSubmap& owner, const Told& told) const {
  return told.page == 0 || owner.submap.revision != told.revision ||
         owner.placement.revision != told.placement_revision || owner.in_map != told.in_map;
}

std::set<SubmapKey> MapStatusPages::choose_submaps(const Atlas& atlas, size_t most) const {
  // The page on which the submap was last, the submap, and whether it has changed since.
  std::vector<std::tuple<int64_t, SubmapKey, bool>> by_age;
  for (const auto& [key, owner] : atlas.submaps()) {
    const auto known = told_.find(key);
    const Told told = known == told_.end() ? Told() : known->second;
    by_age.emplace_back(told.page, key, has_changed(owner, told));
  }
  std::sort(by_age.begin(), by_age.end());
  std::set<SubmapKey> chosen;
  for (const auto& [page, key, changed] : by_age)
    if (changed && chosen.size() < most / 2) chosen.insert(key);
  // At least half of the page goes to the submaps that were told longest ago, so that a late listener learns of all.
  for (const auto& [page, key, changed] : by_age)
    if (chosen.size() < most) chosen.insert(key);
  return chosen;
}

void MapStatusPages::add_links(const Atlas& atlas, int64_t room, map_status_t* page) {
  const std::vector<Link>& links = atlas.links();
  if (next_link_ >= links.size()) next_link_ = 0;
  page->first_link = static_cast<int32_t>(next_link_);
  for (; next_link_ < links.size() && wire_bytes(links[next_link_]) <= room; ++next_link_) {
    room -= wire_bytes(links[next_link_]);
    page->links.push_back(to_wire(links[next_link_]));
  }
  page->nlinks = static_cast<int32_t>(page->links.size());
  links_are_told_ = links_are_told_ || next_link_ == links.size();
}

void MapStatusPages::begin_round() {
  round_begin_ = page_;
  next_link_ = 0;
  round_goes_on_ = true;
  links_are_told_ = false;
}

bool MapStatusPages::all_is_told(const Atlas& atlas) const {
  return links_are_told_ &&
         std::all_of(told_.begin(), told_.end(),
                     [this](const auto& entry) { return entry.second.page > round_begin_; }) &&
         told_.size() == atlas.submaps().size();
}

}  // namespace rumi::map_server
