// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/scene/covisibility.h"

#include <unordered_map>

namespace rumi::viewer_offscreen {

std::vector<std::pair<int, int>> covisible_pairs(const Submap& submap, int min_shared) {
  std::vector<int> ids;
  std::unordered_map<int, int> index_of;
  for (const auto& [id, keyframe] : submap.keyframes) {
    index_of[id] = static_cast<int>(ids.size());
    ids.push_back(id);
  }
  // `observers` lists the keyframes that see each landmark, ascending, one landmark after another. `places` has each
  // keyframe's places in that list.
  std::vector<int> observers;
  std::vector<size_t> end_of;
  std::vector<std::vector<std::pair<size_t, size_t>>> places(ids.size());  // by keyframe: place, landmark
  for (const auto& [id, landmark] : submap.landmarks) {
    for (const Observation& observation : landmark.observations) {
      const auto keyframe = index_of.find(observation.keyframe_id);
      if (keyframe == index_of.end()) continue;
      places[static_cast<size_t>(keyframe->second)].emplace_back(observers.size(), end_of.size());
      observers.push_back(keyframe->second);
    }
    end_of.push_back(observers.size());
  }
  std::vector<std::pair<int, int>> pairs;
  std::vector<int> shared(ids.size());
  for (size_t i = 0; i < ids.size(); ++i) {
    std::fill(shared.begin(), shared.end(), 0);
    for (const auto& [place, landmark] : places[i])
      for (size_t later = place + 1; later < end_of[landmark]; ++later) ++shared[static_cast<size_t>(observers[later])];
    for (size_t j = i + 1; j < ids.size(); ++j)
      if (shared[j] >= min_shared) pairs.emplace_back(ids[i], ids[j]);
  }
  return pairs;
}

}  // namespace rumi::viewer_offscreen
