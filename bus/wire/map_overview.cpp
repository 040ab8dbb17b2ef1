// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/map_overview.h"

#include <algorithm>

namespace rumi {

void MapOverview::take(const map_status_t& status) {
  const auto in_all = static_cast<size_t>(std::max<int64_t>(0, int64_t{status.front_submaps} + status.back_submaps));
  // Within one map the revision never falls and no submap disappears.
  const bool another_map = status.map_revision < map_revision_ || in_all < submaps_.size();
  if (another_map || status.submaps.size() >= in_all) submaps_.clear();
  if (another_map) links_.clear();
  for (const submap_summary_t& summary : status.submaps) submaps_[{summary.session, summary.submap_id}] = summary;
  int64_t number = status.first_link;
  for (const link_t& link : status.links) links_[number++] = link;
  const int end = std::max(status.links_in_all, status.nlinks);
  std::erase_if(links_, [end](const auto& link) { return link.first < 0 || link.first >= end; });

  heard_ = true;
  map_revision_ = status.map_revision;
  submaps_in_all_ = in_all;
  links_in_all_ = static_cast<size_t>(std::max(0, status.links_in_all));
}

}  // namespace rumi
