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

// True if the pose's own keyframe has a placement, or if the placement is empty (then the submap lies in the map
// unchanged). False if the pose has to follow the nearest keyframe that is placed.
bool hangs_on_placed_keyframe(const AtlasSubmap& owner, const FramePose& frame) {
  const Keyframe* keyframe = owner.submap.keyframe(frame.reference_keyframe);
  const auto& places = owner.placement.map_from_submap;
  return keyframe && (places.empty() || places.contains(keyframe->utime_us));
}

bool is_between_its_frames(ImageId image, const Submap& submap) {
  return image.stream == submap.stream && !submap.frames.empty() && submap.frames.begin()->first <= image.utime_us &&
         image.utime_us <= submap.frames.rbegin()->first;
}

}  // namespace

std::string describe(const std::set<SubmapKey>& submaps) {
  constexpr size_t kNamed = 8;
  if (submaps.size() > kNamed || submaps.begin()->session != submaps.rbegin()->session)
    return fmt::format("{} submaps", submaps.size());
  std::vector<int> ids;
  ids.reserve(submaps.size());
  for (const SubmapKey& key : submaps) ids.push_back(key.id);
  // Back submap -n begins in front submap n, so it is listed after it.
  std::sort(ids.begin(), ids.end(),
            [](int a, int b) { return std::pair(std::abs(a), -a) < std::pair(std::abs(b), -b); });
  if (ids.size() == 1) return fmt::format("submap {}", ids[0]);
  return fmt::format("submaps {} and {}", fmt::join(ids.begin(), ids.end() - 1, ", "), ids.back());
}

bool LocatedFrame::is_keyframe() const {
  const Keyframe* keyframe = owner->submap.keyframe(frame->reference_keyframe);
  return keyframe && keyframe->utime_us == frame->utime_us;
}

PoseSigmas LocatedFrame::sigmas() const {
  if (!owner->in_map) return frame->sigmas;
  return scaled(frame->sigmas, owner->placement.at(owner->submap, *frame).scale);
}

Result<> Atlas::change_submap(SubmapKey key, const std::function<Result<>(Submap*)>& change) {
  const auto known = submaps_.find(key);
  AtlasSubmap fresh;
  fresh.submap.key = key;
  Submap* submap = known == submaps_.end() ? &fresh.submap : &known->second.submap;
  const int64_t before = submap->revision;
  if (const Result<> changed = change(submap); !changed) return changed;
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
  submap.frames.for_each_after(after_revision, [&](const FramePose& frame) {
    if (frames_.try_emplace({frame.utime_us, submap.stream}, FrameRecord{.session = submap.key.session}).second)
      ++frames_of_[submap.key.session];
  });
}

Result<> Atlas::check_here(const PlacedMap& map) const {
  for (const SubmapKey& key : map.submaps())
    if (!submaps_.contains(key))
      return Error{fmt::format("submap {} of session {} is not here to be placed", key.id, key.session)};
  return {};
}

Result<> Atlas::check_links(const std::vector<Link>& links) const {
  for (const Link& link : links)
    if (!submaps_.contains(link.a) || !submaps_.contains(link.b) || !is_similarity(link.b_from_a) ||
        !std::isfinite(link.rmse_px))
      return Error{fmt::format("the link of submaps {} and {} is none", link.a.id, link.b.id)};
  return {};
}

Result<> Atlas::check(const PlacedMap& map, const std::vector<Link>& links) const {
  const Result<> valid = check_links(links);
  return valid ? check_here(map) : valid;
}

Result<> Atlas::set_links(std::vector<Link> links) {
  if (const Result<> valid = check_links(links); !valid) return valid;
  links_ = std::move(links);
  return {};
}

std::set<SubmapKey> Atlas::find_same(const PlacedMap& map) const {
  std::set<SubmapKey> same;
  for (const auto& [key, placement] : map.placements())
    if (same_place(submaps_.at(key).placement, placement)) same.insert(key);
  return same;
}

Result<std::vector<Placement>> Atlas::place_map(PlacedMap map) {
  if (const Result<> here = check_here(map); !here) return here.error();
  const std::set<SubmapKey> same = map.same() ? *map.same() : find_same(map);
  const std::set<SubmapKey> beside = map_beside(map.submaps());
  ++revision_;
  std::vector<Placement> before;
  for (auto& [key, owner] : submaps_) {
    owner.in_map = map.contains(key);
    if (map.unmoved().contains(key) || beside.contains(key)) continue;
    const int64_t revision = owner.placement.revision;
    before.push_back(std::exchange(owner.placement, owner.in_map ? map.take_placement(key) : Placement()));
    if (owner.in_map) owner.placement.revision = revision > 0 && same.contains(key) ? revision : revision_;
  }
  choose_map();
  return before;
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

// Returns the submaps that stay beside the served map if `map` becomes the served one. There are any only if all
// submaps of `map` are of present sessions. They are then the submaps of earlier sessions in the served map, or those
// beside it now, whichever have more frames.
std::set<SubmapKey> Atlas::map_beside(const std::set<SubmapKey>& map) const {
  const bool has_earlier = map.empty() || std::any_of(map.begin(), map.end(), [this](const SubmapKey& key) {
                             return !present_.contains(key.session);
                           });
  std::set<SubmapKey> served, beside;
  size_t served_frames = 0, beside_frames = 0;
  for (const auto& [key, owner] : submaps_) {
    if (has_earlier || owner.placement.revision == 0 || present_.contains(key.session)) continue;
    (owner.in_map ? served : beside).insert(key);
    (owner.in_map ? served_frames : beside_frames) += owner.submap.frames.size();
  }
  return served_frames >= beside_frames ? served : beside;
}

bool Atlas::serve_present() {
  std::set<SubmapKey> present;
  for (const auto& [key, owner] : submaps_)
    if (present_.contains(key.session) && !owner.submap.frames.empty()) present.insert(key);
  if (present.empty() || has_present_in_map()) return false;
  const std::set<SubmapKey> beside = map_beside(present);
  for (auto& [key, owner] : submaps_) {
    owner.in_map = false;
    if (!beside.contains(key)) owner.placement = {};
  }
  ++revision_;
  return choose_map();
}

void Atlas::serve_larger() {
  size_t served = 0, beside = 0;
  for (const auto& [key, owner] : submaps_)
    if (owner.in_map || owner.is_beside()) (owner.in_map ? served : beside) += owner.submap.frames.size();
  if (beside <= served) return;
  for (auto& [key, owner] : submaps_) owner.in_map = owner.is_beside();
  ++revision_;
}

bool Atlas::choose_map() {
  if (is_placed()) return false;
  const AtlasSubmap* best = nullptr;
  for (const auto& [key, candidate] : submaps_) {
    // A back submap only connects front submaps, so it is chosen only if there is no front submap.
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
  // A recording that is played again brings the same images again. Each counts once, for the present session first, as
  // in frames_of_.
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
    const FramePose& frame = *s.submap.frame(image.utime_us);
    const bool follows = s.in_map && !hangs_on_placed_keyframe(s, frame);
    const bool was_adjusted = s.in_map && LocatedFrame{&s, &frame}.is_keyframe();
    // Every frame of a back submap was adjusted with the others when it was rebuilt. front_tracker's pose of a frame
    // between keyframes is that of one image alone, and its keyframes agree with those of back submaps or are wrong.
    const bool was_not_rebuilt = s.in_map && s.submap.kind != SubmapKind::kBack;
    return std::make_tuple(!s.in_map, follows, !was_adjusted, was_not_rebuilt, !tracked_in,
                           s.submap.kind != SubmapKind::kFront);
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
