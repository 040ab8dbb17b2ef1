// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/atlas.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace rumi {
namespace {

int64_t first_utime_us(const Submap& submap) {
  return submap.frames.empty() ? std::numeric_limits<int64_t>::max() : submap.frames.begin()->first;
}

}  // namespace

const char* to_string(FrameState state) {
  switch (state) {
    case FrameState::kNotInitialized:
      return "NOT_INITIALIZED";
    case FrameState::kTracking:
      return "TRACKING";
    case FrameState::kRecentlyLost:
      return "RECENTLY_LOST";
    case FrameState::kLost:
      return "LOST";
    case FrameState::kUnknown:
      break;
  }
  return "UNKNOWN";
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

bool Atlas::record_frame(int64_t utime_us, const FrameRecord& record) {
  const auto [it, is_new] = frames_.try_emplace(utime_us, record);
  if (is_new) return true;
  if (it->second == record) return false;
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
    if (frame.revision > after_revision) frames_.try_emplace(utime_us, FrameRecord{.session = submap.key.session});
}

bool Atlas::choose_map() {
  const AtlasSubmap* best = nullptr;
  for (const auto& [key, candidate] : submaps_) {
    const auto rank = [](const Submap& s) {
      return std::make_tuple(-static_cast<int64_t>(s.frames.size()), first_utime_us(s));
    };
    if (candidate.submap.kind == SubmapKind::kBack) continue;  // it serves to join front submaps
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

int64_t Atlas::frames_in_map() const {
  std::vector<const Submap*> counted;
  int64_t frames = 0;
  for (const auto& [key, owner] : submaps_) {
    if (!owner.in_map) continue;
    for (const auto& [utime_us, frame] : owner.submap.frames)
      frames += std::none_of(counted.begin(), counted.end(),
                             [utime = utime_us](const Submap* s) { return s->frame(utime) != nullptr; });
    counted.push_back(&owner.submap);
  }
  return frames;
}

std::optional<LocatedFrame> Atlas::locate(int64_t utime_us) const {
  const auto record = frames_.find(utime_us);
  const auto order = [&](const AtlasSubmap& s) {
    const bool tracked_in =
        record != frames_.end() && s.submap.key == SubmapKey{record->second.session, record->second.submap_id};
    return std::make_tuple(!s.in_map, !tracked_in, s.submap.kind != SubmapKind::kFront);
  };
  const AtlasSubmap* best = nullptr;
  for (const auto& [key, candidate] : submaps_)
    if (candidate.submap.frame(utime_us) && (!best || order(candidate) < order(*best))) best = &candidate;
  if (!best) return std::nullopt;
  return LocatedFrame{best, best->submap.frame(utime_us)};
}

std::map<int64_t, SE3> Atlas::map_trajectory() const {
  std::map<int64_t, SE3> trajectory;
  for (const auto& [key, owner] : submaps_) {
    if (!owner.in_map) continue;
    for (const auto& [utime_us, frame] : owner.submap.frames) {
      if (trajectory.contains(utime_us)) continue;
      trajectory.emplace(utime_us, locate(utime_us)->cam_from_map().inverse());
    }
  }
  return trajectory;
}

}  // namespace rumi
