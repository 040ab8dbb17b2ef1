// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_members.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace rumi::map_server {
namespace {

struct GroupSize {
  std::set<ImageId> frames;
  size_t present_frames = 0;
  bool has_front = false;  // decides between groups that are otherwise equal

  bool operator<(const GroupSize& other) const {
    return std::tuple(present_frames, frames.size(), has_front) <
           std::tuple(other.present_frames, other.frames.size(), other.has_front);
  }
};

void count(const Submap& submap, bool is_present, GroupSize* size) {
  size->has_front = size->has_front || submap.kind == SubmapKind::kFront;
  const size_t before = size->frames.size();
  for (const auto& [utime_us, frame] : submap.frames) size->frames.insert({utime_us, submap.stream});
  if (is_present) size->present_frames += size->frames.size() - before;
}

}  // namespace

std::set<SubmapKey> choose_members(const LinkGraph& graph, const BuildInput& input) {
  Groups groups = graph.groups();
  for (const SubmapKey& key : input.fixed) groups.unite(key, *input.fixed.begin());
  std::map<size_t, GroupSize> sizes;
  for (const auto& [key, submap] : input.submaps)
    count(*submap, input.present.contains(key.session), &sizes[groups.find(key)]);
  if (!input.fixed.empty())
    std::erase_if(sizes, [&](const auto& group) { return group.first != groups.find(*input.fixed.begin()); });
  const auto largest =
      std::max_element(sizes.begin(), sizes.end(), [](const auto& x, const auto& y) { return x.second < y.second; });
  std::set<SubmapKey> members;
  if (largest == sizes.end()) return members;
  for (const auto& [key, submap] : input.submaps)
    if (groups.find(key) == largest->first) members.insert(key);
  return members;
}

}  // namespace rumi::map_server
