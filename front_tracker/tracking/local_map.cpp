// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/local_map.h"

#include <algorithm>
#include <map>
#include <set>

namespace rumi::front_tracker {
namespace {

// Returns the keyframes that observe the frame's matches, those with the most matches first; of equal ones, the older
// first.
std::vector<int> sharing_keyframes(const Submap& map, const Frame& frame) {
  std::map<int, int> votes;
  for (int id : frame.landmark_ids)
    if (const Landmark* lm = id == kNone ? nullptr : map.landmark(id))
      for (const Observation& o : lm->observations) ++votes[o.keyframe_id];
  std::vector<std::pair<int, int>> ranked(votes.begin(), votes.end());
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<int> ids;
  ids.reserve(ranked.size());
  for (const auto& [id, shared] : ranked) ids.push_back(id);
  return ids;
}

std::set<int> with_neighbours(const Submap& map, const std::vector<int>& sharing, size_t wanted) {
  std::set<int> keyframes(sharing.begin(), sharing.begin() + static_cast<long>(std::min(wanted, sharing.size())));
  if (keyframes.size() >= wanted || sharing.empty()) return keyframes;
  for (const auto& [id, shared] : map.covisible_keyframes(sharing.front())) {
    if (keyframes.size() >= wanted) break;
    keyframes.insert(id);
  }
  return keyframes;
}

}  // namespace

LocalMap local_map(const Submap& map, const Frame& frame, int keyframes) {
  const std::vector<int> sharing = sharing_keyframes(map, frame);
  LocalMap local{sharing.empty() ? frame.reference_keyframe : sharing.front(), {}};
  // Neighbours share most of their landmarks, so marking known ones is cheaper than sorting all of them.
  std::vector<bool> known(map.landmarks.empty() ? 0 : map.landmarks.rbegin()->first + 1, false);
  for (int id : frame.landmark_ids)
    if (id != kNone && map.landmark(id)) known[id] = true;
  std::vector<int> ids;
  for (int keyframe : with_neighbours(map, sharing, static_cast<size_t>(keyframes)))
    for (int id : map.keyframe(keyframe)->landmark_ids) {
      if (id == kNone || known[id]) continue;
      known[id] = true;
      ids.push_back(id);
    }
  std::sort(ids.begin(), ids.end());
  local.landmarks.reserve(ids.size());
  for (int id : ids) local.landmarks.push_back(map.landmark(id));
  return local;
}

}  // namespace rumi::front_tracker
