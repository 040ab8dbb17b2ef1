// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/relocalization/back_submaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "bus/wire/calibration.h"
#include "slam/map/landmark_view.h"

namespace rumi::front_tracker {
namespace {

// The largest distance from the submap's origin, in its unit; its scenes are about one unit away. Nothing real is
// farther, and squares must not overflow.
constexpr double kFarthest = 1e9;

// Returns an Error if the submap lacks something that a tracker relies on. Checks only what every update's checks
// (bus/wire/submap_update.h) leave open.
Result<> check(const Submap& submap, const Camera& camera, const Pyramid& pyramid, int max_keyframes) {
  if (submap.kind != SubmapKind::kBack) return Error{"it is not a back submap"};
  if (camera_to_yaml(submap.camera) != camera_to_yaml(camera))
    return Error{fmt::format("it is of another camera: {} x {} px, fx {}, and not {} x {} px, fx {}",
                             submap.camera.width, submap.camera.height, submap.camera.fx, camera.width, camera.height,
                             camera.fx)};
  if (submap.pyramid != pyramid)
    return Error{fmt::format("it is of another pyramid: {} levels, each {} of the last, and not {}, {}",
                             submap.pyramid.levels, submap.pyramid.scale_factor, pyramid.levels, pyramid.scale_factor)};
  if (submap.keyframes.size() > static_cast<size_t>(max_keyframes))
    return Error{fmt::format("it has {} keyframes, {} are kept at most", submap.keyframes.size(), max_keyframes)};
  std::map<int64_t, int> at;
  for (const auto& [id, kf] : submap.keyframes) {
    if (const auto [other, is_new] = at.emplace(kf.utime_us, id); !is_new)
      return Error{fmt::format("keyframes {} and {} are both of utime {}", other->second, id, kf.utime_us)};
    if (!(kf.cam_from_submap.translation.norm() < kFarthest))
      return Error{fmt::format("keyframe {}: {} is too far away", id, kf.cam_from_submap.translation.norm())};
  }
  for (const auto& [id, lm] : submap.landmarks)
    if (!(lm.position.norm() < kFarthest))
      return Error{fmt::format("landmark {}: {} is too far away", id, lm.position.norm())};
  return {};
}

// Returns the submap with its keyframes numbered in order of time, and only with landmarks that at least two keyframes
// observe in front of them.
Submap tidy(const Submap& received) {
  Submap tidied;
  tidied.key = received.key;
  tidied.kind = received.kind;
  tidied.camera = received.camera;
  tidied.pyramid = received.pyramid;
  tidied.revision = received.revision;
  std::map<int64_t, const Keyframe*> in_time;
  for (const auto& [id, kf] : received.keyframes) in_time[kf.utime_us] = &kf;
  std::map<int, int> new_id;
  for (const auto& [utime_us, old] : in_time) {
    const int id = static_cast<int>(tidied.keyframes.size());
    Keyframe& kf = tidied.keyframes[id] = *old;
    kf.id = new_id[old->id] = id;
    std::fill(kf.landmark_ids.begin(), kf.landmark_ids.end(), kNone);
    tidied.frames.set({utime_us, id, SE3(), tidied.revision});
  }
  for (const auto& [old_id, old] : received.landmarks) {
    std::vector<Observation> seen;
    for (const Observation& o : old.observations)
      if ((received.keyframe(o.keyframe_id)->cam_from_submap * old.position).z() > 0) seen.push_back(o);
    if (seen.size() < 2) continue;
    const int id = static_cast<int>(tidied.landmarks.size());
    Landmark& lm = tidied.landmarks[id];
    lm.id = id;
    lm.position = old.position;
    for (const Observation& o : seen) tidied.add_observation(id, new_id.at(o.keyframe_id), o.keypoint_index);
    update_landmark_view(tidied, &lm);
  }
  return tidied;
}

int64_t first_utime_us(const Submap& submap) { return submap.frames.begin()->first; }

}  // namespace

BackSubmaps::BackSubmaps(const Camera& camera, const TrackingOptions& options, const Pyramid& pyramid)
    : camera_(camera), options_(options), pyramid_(pyramid), relocalizer_(camera, options, pyramid.scales()) {}

Result<> BackSubmaps::add(Submap submap) {
  if (const Result<> usable = check(submap, camera_, pyramid_, options_.back_keyframes); !usable)
    return Error{fmt::format("back submap {}: {}", submap.key.id, usable.error_text())};
  remove(submap.key.id);
  if (submap.keyframes.empty()) return {};
  Entry entry{next_number_++, tidy(submap)};
  for (const auto& [id, kf] : entry.submap.keyframes) relocalizer_.add_keyframe(entry.number, entry.submap, kf);
  const auto later = std::find_if(submaps_.begin(), submaps_.end(), [&](const Entry& other) {
    return first_utime_us(other.submap) > first_utime_us(entry.submap);
  });
  submaps_.insert(later, std::move(entry));
  while (keyframes() > options_.back_keyframes) remove(submaps_.begin());
  return {};
}

void BackSubmaps::remove(int id) {
  const auto entry =
      std::find_if(submaps_.begin(), submaps_.end(), [id](const Entry& e) { return e.submap.key.id == id; });
  if (entry != submaps_.end()) remove(entry);
}

void BackSubmaps::remove(std::vector<Entry>::iterator entry) {
  relocalizer_.forget_submap(entry->number);
  submaps_.erase(entry);
}

std::optional<BackSubmaps::Found> BackSubmaps::relocalize(const Frame& frame) {
  if (submaps_.empty()) return std::nullopt;
  for (const Relocalizer::Candidate& c : relocalizer_.candidates(frame)) {
    const auto entry =
        std::find_if(submaps_.begin(), submaps_.end(), [&](const Entry& e) { return e.number == c.submap_index; });
    std::optional<Frame> posed = relocalizer_.relocalize(entry->submap, c.keyframe_id, frame);
    if (!posed) continue;
    Found found{std::move(entry->submap), std::move(*posed)};
    remove(entry);
    return found;
  }
  return std::nullopt;
}

int BackSubmaps::keyframes() const {
  return std::accumulate(submaps_.begin(), submaps_.end(), 0, [](int sum, const Entry& entry) {
    return sum + static_cast<int>(entry.submap.keyframes.size());
  });
}

}  // namespace rumi::front_tracker
