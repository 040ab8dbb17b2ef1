// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_part.h"

#include <algorithm>
#include <map>
#include <vector>

namespace rumi::map_server {

MapPart part_around(const std::set<SubmapKey>& fresh, const std::set<SubmapKey>& members, const SubmapPairs& contacts,
                    const Submaps& submaps, int keyframes) {
  std::map<SubmapKey, std::vector<SubmapKey>> neighbours;
  for (const auto& [a, b] : contacts) {
    if (!members.contains(a) || !members.contains(b)) continue;
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  MapPart part{fresh, {}};
  std::vector<SubmapKey> queue(fresh.begin(), fresh.end());
  size_t count = 0;
  for (const SubmapKey& key : fresh) count += submaps.at(key)->keyframes.size();
  for (size_t i = 0; i < queue.size(); ++i)
    for (const SubmapKey& other : neighbours[queue[i]]) {
      if (i >= fresh.size() && count >= static_cast<size_t>(keyframes)) break;
      if (!part.submaps.insert(other).second) continue;
      queue.push_back(other);
      count += submaps.at(other)->keyframes.size();
    }
  for (const SubmapKey& key : part.submaps)
    if (std::any_of(neighbours[key].begin(), neighbours[key].end(),
                    [&](const SubmapKey& other) { return !part.submaps.contains(other); }))
      part.fixed.insert(key);
  return part;
}

}  // namespace rumi::map_server
