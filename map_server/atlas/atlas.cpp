// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/atlas/atlas.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "map_server/links/may_share_images.h"

namespace rumi::map_server {
namespace {

constexpr size_t kMostMasks = 64;

int64_t first_utime_us(const Submap& submap) {
  return submap.frames.empty() ? std::numeric_limits<int64_t>::max() : submap.frames.begin()->first;
}

// The pose does not merely follow a neighbour of its keyframe that was placed. Always so where the submap lies in the
// map as it is.
bool hangs_on_placed_keyframe(const AtlasSubmap& owner, const FramePose& frame) {
  const Keyframe* keyframe = owner.submap.keyframe(frame.reference_keyframe);
  const auto& places = owner.placement.map_from_submap;
  return keyframe && (places.empty() || places.contains(keyframe->utime_us));
}

bool is_between_its_frames(ImageId image, const Submap& submap) {
  return image.stream == submap.stream && !submap.frames.empty() && submap.frames.begin()->first <= image.utime_us &&
         image.utime_us <= submap.frames.rbegin()->first;
}

bool is_similarity(const Sim3& s) { return s.is_finite() && s.scale > 0; }

void check_placement(SubmapKey key, const Placement& placement, const std::function<bool(SubmapKey)>& is_in_map) {
  bool ok = true;
  for (const auto& [utime_us, similarity] : placement.map_from_submap) ok = ok && is_similarity(similarity);
  for (const auto& [id, position] : placement.landmarks) ok = ok && position.allFinite();
  for (const auto& [id, into] : placement.fused) ok = ok && is_in_map(into.submap);
  if (!ok)
    throw std::invalid_argument(
        fmt::format("the placement of submap {} of session {} is not valid", key.id, key.session));
}

}  // namespace

std::string describe(const std::set<SubmapKey>& submaps) {
  constexpr size_t kNamed = 8;
  if (submaps.size() > kNamed || submaps.begin()->session != submaps.rbegin()->session)
    return fmt::format("{} submaps", submaps.size());
  std::vector<int> ids;
  ids.reserve(submaps.size());
  for (const SubmapKey& key : submaps) ids.push_back(key.id);
  // A back submap comes after the front submap of its number, which it begins in.
  std::sort(ids.begin(), ids.end(),
            [](int a, int b) { return std::pair(std::abs(a), -a) < std::pair(std::abs(b), -b); });
  if (ids.size() == 1) return fmt::format("submap {}", ids[0]);
  return fmt::format("submaps {} and {}", fmt::join(ids.begin(), ids.end() - 1, ", "), ids.back());
}

PoseSigmas LocatedFrame::sigmas() const {
  if (!owner->in_map) return frame->sigmas;
  return scaled(frame->sigmas, owner->placement.at(owner->submap, *frame).scale);
}

std::string Atlas::change_submap(SubmapKey key, const std::function<std::string(Submap*)>& change) {
  const auto known = submaps_.find(key);
  AtlasSubmap fresh;
  fresh.submap.key = key;
  Submap* submap = known == submaps_.end() ? &fresh.submap : &known->second.submap;
  const int64_t before = submap->revision;
  if (std::string problem = change(submap); !problem.empty()) return problem;
  if (submap->revision == before) return {};
  if (known == submaps_.end()) submap = &submaps_.emplace(key, std::move(fresh)).first->second.submap;
  note_frames(*submap, before);
  if (choose_map() || submaps_.at(key).in_map) ++revision_;
  return {};
}

bool Atlas::record_mask(int64_t stream, StillMask mask) {
  const auto known = masks_.find(stream);
  if (known != masks_.end() && (known->second.is_same(mask) || !mask.is_newer(known->second))) return false;
  masks_[stream] = std::move(mask);
  const auto is_older = [](const auto& a, const auto& b) { return b.second.is_newer(a.second); };
  if (masks_.size() > kMostMasks) masks_.erase(std::min_element(masks_.begin(), masks_.end(), is_older));
  return true;
}

bool Atlas::record_frame(ImageId image, const FrameRecord& record) {
  const auto [it, is_new] = frames_.try_emplace(image, record);
  if (!is_new && it->second == record) return false;
  if (!is_new) --frames_of_[it->second.session];
  ++frames_of_[record.session];
  it->second = record;
  return true;
}

void Atlas::restore_submap(AtlasSubmap submap) {
  const SubmapKey key = submap.submap.key;
  const auto it = submaps_.insert_or_assign(key, std::move(submap)).first;
  note_frames(it->second.submap, std::numeric_limits<int64_t>::min());
}

void Atlas::note_frames(const Submap& submap, int64_t after_revision) {
  for (const auto& [utime_us, frame] : submap.frames)
    if (frame.revision > after_revision &&
        frames_.try_emplace({utime_us, submap.stream}, FrameRecord{.session = submap.key.session}).second)
      ++frames_of_[submap.key.session];
}

void Atlas::check_here(const std::map<SubmapKey, Placement>& placements, const std::set<SubmapKey>& unmoved) const {
  const auto check = [this](SubmapKey key) {
    if (!submaps_.contains(key))
      throw std::invalid_argument(fmt::format("submap {} of session {} is not here to be placed", key.id, key.session));
  };
  for (const SubmapKey& key : unmoved) check(key);
  for (const auto& [key, placement] : placements) check(key);
}

void Atlas::check_numbers(const std::map<SubmapKey, Placement>& placements, const std::set<SubmapKey>& unmoved) {
  const auto is_in_map = [&](SubmapKey key) { return placements.contains(key) || unmoved.contains(key); };
  for (const auto& [key, placement] : placements) check_placement(key, placement, is_in_map);
}

void Atlas::place_map(std::map<SubmapKey, Placement> placements, const std::set<SubmapKey>& unmoved) {
  check_numbers(placements, unmoved);
  std::set<SubmapKey> same;
  for (const auto& [key, placement] : placements)
    if (const AtlasSubmap* owner = find(key); owner && same_place(owner->placement, placement)) same.insert(key);
  swap_map(std::move(placements), unmoved, same);
}

std::vector<Placement> Atlas::swap_map(std::map<SubmapKey, Placement> placements, const std::set<SubmapKey>& unmoved,
                                       const std::set<SubmapKey>& same) {
  check_here(placements, unmoved);
  ++revision_;
  std::set<SubmapKey> map = unmoved;
  for (const auto& [key, placement] : placements) map.insert(key);
  const std::set<SubmapKey> kept = to_be_kept(map);
  std::vector<Placement> before;
  for (auto& [key, owner] : submaps_) {
    const auto placed = placements.find(key);
    owner.in_map = unmoved.contains(key) || placed != placements.end();
    if (unmoved.contains(key) || kept.contains(key)) continue;
    const int64_t revision = owner.placement.revision;
    before.push_back(std::exchange(owner.placement, owner.in_map ? std::move(placed->second) : Placement()));
    if (owner.in_map) owner.placement.revision = revision > 0 && same.contains(key) ? revision : revision_;
  }
  choose_map();
  return before;
}

void Atlas::check_links(const std::vector<Link>& links) const {
  for (const Link& link : links)
    if (!submaps_.contains(link.a) || !submaps_.contains(link.b) || !is_similarity(link.b_from_a) ||
        !std::isfinite(link.rmse_px))
      throw std::invalid_argument(fmt::format("the link of submaps {} and {} is none", link.a.id, link.b.id));
}

void Atlas::set_links(std::vector<Link> links) {
  check_links(links);
  links_ = std::move(links);
}

bool Atlas::is_placed() const {
  return std::any_of(submaps_.begin(), submaps_.end(),
                     [](const auto& entry) { return entry.second.in_map && entry.second.placement.revision > 0; });
}

bool Atlas::has_present_in_map() const {
  return std::any_of(submaps_.begin(), submaps_.end(), [this](const auto& entry) {
    return entry.second.in_map && present_.contains(entry.first.session);
  });
}

// With a map of present sessions only: that of earlier ones, the larger one if there are two.
std::set<SubmapKey> Atlas::to_be_kept(const std::set<SubmapKey>& map) const {
  const bool has_earlier = map.empty() || std::any_of(map.begin(), map.end(), [this](const SubmapKey& key) {
                             return !present_.contains(key.session);
                           });
  std::set<SubmapKey> served, kept;
  size_t served_frames = 0, kept_frames = 0;
  for (const auto& [key, owner] : submaps_) {
    if (has_earlier || owner.placement.revision == 0 || present_.contains(key.session)) continue;
    (owner.in_map ? served : kept).insert(key);
    (owner.in_map ? served_frames : kept_frames) += owner.submap.frames.size();
  }
  return served_frames >= kept_frames ? served : kept;
}

bool Atlas::serve_present() {
  std::set<SubmapKey> present;
  for (const auto& [key, owner] : submaps_)
    if (present_.contains(key.session) && !owner.submap.frames.empty()) present.insert(key);
  if (present.empty() || has_present_in_map()) return false;
  const std::set<SubmapKey> kept = to_be_kept(present);
  for (auto& [key, owner] : submaps_) {
    owner.in_map = false;
    if (!kept.contains(key)) owner.placement = {};
  }
  ++revision_;
  return choose_map();
}

void Atlas::serve_larger() {
  size_t served = 0, kept = 0;
  for (const auto& [key, owner] : submaps_)
    if (owner.in_map || owner.is_kept()) (owner.in_map ? served : kept) += owner.submap.frames.size();
  if (kept <= served) return;
  for (auto& [key, owner] : submaps_) owner.in_map = owner.is_kept();
  ++revision_;
}

bool Atlas::choose_map() {
  if (is_placed()) return false;
  const AtlasSubmap* best = nullptr;
  for (const auto& [key, candidate] : submaps_) {
    // A back submap serves to join front submaps, and stands for itself where there is none.
    const auto rank = [this](const Submap& s) {
      return std::make_tuple(!present_.contains(s.key.session), s.kind != SubmapKind::kFront || s.frames.empty(),
                             -static_cast<int64_t>(s.frames.size()), first_utime_us(s));
    };
    if (!best || rank(candidate.submap) < rank(best->submap)) best = &candidate;
  }
  bool changed = false;
  for (auto& [key, submap] : submaps_) {
    const bool in_map = &submap == best;
    changed = changed || in_map != submap.in_map;
    submap.in_map = in_map;
  }
  return changed;
}

const AtlasSubmap* Atlas::find(SubmapKey key) const {
  const auto it = submaps_.find(key);
  return it == submaps_.end() ? nullptr : &it->second;
}

bool Atlas::stands_for_itself(const AtlasSubmap& owner, int landmark_id) const {
  const auto fused = owner.placement.fused.find(landmark_id);
  if (fused == owner.placement.fused.end()) return true;
  const AtlasSubmap* other = find(fused->second.submap);
  return !other || !other->in_map || !other->submap.landmark(fused->second.id);
}

std::set<SubmapKey> Atlas::in_map() const {
  std::set<SubmapKey> keys;
  for (const auto& [key, owner] : submaps_)
    if (owner.in_map) keys.insert(key);
  return keys;
}

const Atlas::Counted& Atlas::count(const AtlasSubmap& owner, const std::vector<const Submap*>& before) const {
  std::vector<const Submap*> beside;
  std::vector<std::pair<SubmapKey, int64_t>> of{{owner.submap.key, owner.submap.revision}};
  for (const Submap* other : before)
    if (may_share_images(*other, owner.submap)) {
      beside.push_back(other);
      of.emplace_back(other->key, other->revision);
    }
  Counted& counted = counted_[owner.submap.key];
  if (counted.of == of) return counted;
  counted = {std::move(of), 0};
  for (const auto& [utime_us, frame] : owner.submap.frames)
    counted.frames += std::none_of(beside.begin(), beside.end(),
                                   [utime = utime_us](const Submap* s) { return s->frame(utime) != nullptr; });
  return counted;
}

Atlas::FrameCounts Atlas::count_frames() const {
  FrameCounts counts;
  for (const auto& [session, frames] : frames_of_)
    (present_.contains(session) ? counts.present : counts.earlier) += frames;
  // A recording that is played again has the same images: they are of the session that goes on, as frames_of_ has it.
  std::vector<const Submap*> counted;
  for (const bool present : {true, false})
    for (const auto& [key, owner] : submaps_) {
      if (!owner.in_map || present_.contains(key.session) != present) continue;
      counts.is_joined = counts.is_joined || (!present && counts.present_in_map > 0);
      (present ? counts.present_in_map : counts.earlier_in_map) += count(owner, counted).frames;
      counted.push_back(&owner.submap);
    }
  return counts;
}

int64_t Atlas::frames_in_map() const {
  const FrameCounts counts = count_frames();
  return counts.present_in_map + counts.earlier_in_map;
}

std::optional<LocatedFrame> Atlas::locate(ImageId image) const {
  const auto record = frames_.find(image);
  const auto order = [&](const AtlasSubmap& s) {
    const bool tracked_in =
        record != frames_.end() && s.submap.key == SubmapKey{record->second.session, record->second.submap_id};
    const bool follows = s.in_map && !hangs_on_placed_keyframe(s, *s.submap.frame(image.utime_us));
    return std::make_tuple(!s.in_map, follows, !tracked_in, s.submap.kind != SubmapKind::kFront);
  };
  const AtlasSubmap* best = nullptr;
  for (const auto& [key, candidate] : submaps_)
    if (is_between_its_frames(image, candidate.submap) && candidate.submap.frame(image.utime_us) &&
        (!best || order(candidate) < order(*best)))
      best = &candidate;
  if (!best) return std::nullopt;
  return LocatedFrame{best, best->submap.frame(image.utime_us)};
}

std::map<ImageId, SE3> Atlas::map_trajectory() const {
  std::map<ImageId, SE3> trajectory;
  for (const auto& [key, owner] : submaps_) {
    if (!owner.in_map) continue;
    for (const auto& [utime_us, frame] : owner.submap.frames) {
      const ImageId image{utime_us, owner.submap.stream};
      if (!trajectory.contains(image)) trajectory.emplace(image, locate(image)->cam_from_map().inverse());
    }
  }
  return trajectory;
}

}  // namespace rumi::map_server
