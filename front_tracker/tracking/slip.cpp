// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/slip.h"

namespace rumi::front_tracker {
namespace {

// True if one of the newest keyframes since `begin_us` contradicts the pose of `found`.
bool is_torn(const Relocalizer& relocalizer, const Submap& map, const Frame& found, int64_t begin_us) {
  constexpr int kCompared = 3;
  auto kf = map.keyframes.rbegin();
  for (int i = 0; i < kCompared && kf != map.keyframes.rend(); ++i, ++kf)
    if (kf->second.utime_us >= begin_us && relocalizer.contradicts(map, kf->first, found)) return true;
  return false;
}

}  // namespace

std::vector<int64_t> withdraw_slip(const Relocalizer& relocalizer, const Frame& found, SupportHistory* history,
                                   FrontSubmap* submap) {
  const Submap& map = submap->map;
  const std::optional<int64_t> begin_us = history->begin_us();
  if (!begin_us || !is_torn(relocalizer, map, found, *begin_us)) return {};
  const int64_t first_us = history->weak_since_us();
  if (map.keyframe(found.reference_keyframe)->utime_us >= first_us ||
      map.keyframes.begin()->second.utime_us >= first_us)
    return {};
  std::vector<int64_t> withdrawn;
  for (auto frame = map.frames.lower_bound(first_us); frame != map.frames.end(); ++frame)
    withdrawn.push_back(frame->first);
  submap->cut_end(first_us);
  history->forget_from(first_us);
  return withdrawn;
}

}  // namespace rumi::front_tracker
