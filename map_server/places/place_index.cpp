// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_index.h"

#include <algorithm>
#include <cstdlib>
#include <set>

namespace rumi::map_server {

void PlaceIndex::add(const Submap& submap, const Keyframe& keyframe) {
  remove(submap.key, keyframe.id);
  const int64_t number = next_number_++;
  index_.add(number, landmark_descriptors(keyframe));
  numbers_[{submap.key, keyframe.id}] = number;
  places_[number] = {submap.key, keyframe.id, submap.image(keyframe)};
}

void PlaceIndex::remove(SubmapKey submap, int keyframe) {
  const auto it = numbers_.find({submap, keyframe});
  if (it == numbers_.end()) return;
  index_.remove(it->second);
  places_.erase(it->second);
  numbers_.erase(it);
}

void PlaceIndex::remove_if(const std::function<bool(const Place&)>& gone) {
  std::vector<Place> removed;
  for (const auto& [number, place] : places_)
    if (gone(place)) removed.push_back(place);
  for (const Place& place : removed) remove(place.submap, place.keyframe);
}

std::vector<PlaceCandidate> PlaceIndex::query(const std::vector<Descriptor>& descriptors, size_t count,
                                              int64_t separation_us,
                                              const std::function<bool(const Place&)>& exclude) const {
  std::vector<PlaceCandidate> found;
  for (const auto& [number, score] : index_.query(descriptors, size())) {
    if (found.size() == count) break;
    const Place& place = places_.at(number);
    if (exclude && exclude(place)) continue;
    const bool shown = std::any_of(found.begin(), found.end(), [&](const PlaceCandidate& better) {
      return better.place.submap == place.submap &&
             std::abs(better.place.image.utime_us - place.image.utime_us) < separation_us;
    });
    if (!shown) found.push_back({place, score});
  }
  return found;
}

std::vector<int> landmark_keypoints(const Keyframe& keyframe) {
  std::vector<int> keypoints;
  if (!keyframe.features) return keypoints;
  const size_t n = std::min(keyframe.landmark_ids.size(), keyframe.features->descriptors.size());
  for (size_t i = 0; i < n; ++i)
    if (keyframe.landmark_ids[i] != kNone) keypoints.push_back(static_cast<int>(i));
  return keypoints;
}

std::vector<Descriptor> landmark_descriptors(const Keyframe& keyframe) {
  std::vector<Descriptor> descriptors;
  for (int i : landmark_keypoints(keyframe)) descriptors.push_back(keyframe.features->descriptors[i]);
  return descriptors;
}

std::function<bool(const Place&)> exclude_surroundings(const Submap& submap, int keyframe_id, int64_t min_apart_us) {
  std::set<int> near{keyframe_id};
  for (const auto& [id, shared] : submap.covisible_keyframes(keyframe_id)) near.insert(id);
  const Keyframe* keyframe = submap.keyframe(keyframe_id);
  const int64_t utime_us = keyframe ? keyframe->utime_us : 0;
  return [near, utime_us, min_apart_us, key = submap.key](const Place& place) {
    return place.submap == key &&
           (near.contains(place.keyframe) || std::abs(place.image.utime_us - utime_us) < min_apart_us);
  };
}

}  // namespace rumi::map_server
