// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/removals.h"

#include <algorithm>

namespace rumi {

void Removals::add(int id, int64_t revision) {
  if (in_order_.size() == kMost) forget(in_order_[kMost / 2].revision);
  in_order_.push_back({revision, id});
}

void Removals::forget(int64_t revision) {
  forgotten_revision_ = std::max(forgotten_revision_, revision);
  std::erase_if(in_order_, [this](const Removal& removal) { return removal.revision <= forgotten_revision_; });
}

std::optional<std::vector<int>> Removals::since(int64_t revision) const {
  if (revision < forgotten_revision_) return std::nullopt;
  std::vector<int> ids;
  for (auto removal = in_order_.rbegin(); removal != in_order_.rend() && removal->revision > revision; ++removal)
    ids.push_back(removal->id);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace rumi
