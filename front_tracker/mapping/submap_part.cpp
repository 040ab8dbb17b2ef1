// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/mapping/submap_part.h"

#include <set>
#include <utility>

namespace rumi::front_tracker {
namespace {

std::set<int> keyframes_around(const Submap& map, int keyframe_id, size_t count) {
  std::set<int> around{keyframe_id};
  for (const auto& [id, shared] : map.covisible_keyframes(keyframe_id)) {
    if (around.size() >= count) break;
    around.insert(id);
  }
  return around;
}

// Copies the landmark with its observations by these keyframes. Does nothing if there is only one.
void copy_landmark(const Landmark& landmark, const std::set<int>& keyframes, Submap* part) {
  Landmark copy = landmark;
  std::erase_if(copy.observations, [&](const Observation& o) { return !keyframes.contains(o.keyframe_id); });
  if (copy.observations.size() >= 2) part->landmarks.emplace(copy.id, std::move(copy));
}

Submap part_of(const Submap& map, const std::set<int>& keyframes) {
  Submap part;
  part.camera = map.camera;
  part.pyramid = map.pyramid;
  part.stream = map.stream;
  for (const int id : keyframes) {
    Keyframe& copy = part.keyframes.emplace(id, *map.keyframe(id)).first->second;
    for (int& landmark_id : copy.landmark_ids) {
      if (landmark_id == kNone) continue;
      if (!part.landmark(landmark_id)) copy_landmark(*map.landmark(landmark_id), keyframes, &part);
      if (!part.landmark(landmark_id)) landmark_id = kNone;
    }
    const FramePose* frame = map.frame(copy.utime_us);
    part.frames.set({copy.utime_us, id, SE3(), 0, frame ? frame->sigmas : PoseSigmas()});
  }
  return part;
}

}  // namespace

std::unique_ptr<FrontSubmap> go_on_from(FrontSubmap& full, SubmapKey key, int64_t utime_us, size_t keyframes) {
  const FramePose frame = full.map.frames.at(utime_us);
  const std::set<int> around = keyframes_around(full.map, frame.reference_keyframe, keyframes);
  Submap part = part_of(full.map, around);
  part.frames.set(frame);
  auto submap = std::make_unique<FrontSubmap>(std::move(part), key);
  for (const auto& [id, certainty] : full.certainty)
    if (around.contains(id)) submap->certainty.emplace(id, certainty);
  for (const auto& [id, images] : full.images)
    if (around.contains(id)) submap->images.emplace(id, images);
  for (const auto& recent : full.recent_landmarks)
    if (submap->map.landmark(recent.first)) submap->recent_landmarks.push_back(recent);
  full.keep_images(0);
  return submap;
}

}  // namespace rumi::front_tracker
