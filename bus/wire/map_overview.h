// SPDX-License-Identifier: BSD-3-Clause
// Collects what RUMI_MAP_STATUS tells about a map that may need several pages.
#pragma once

#include <map>

#include "lcmtypes/rumi/map_status_t.hpp"
#include "slam/map/submap.h"

namespace rumi {

class MapOverview {
 public:
  // Takes in a page. Submaps and links that it does not list stay as they were last told, with two exceptions: a page
  // of another map replaces everything, and a page with all submaps replaces the submaps.
  void take(const map_status_t& status);

  const std::map<SubmapKey, submap_summary_t>& submaps() const { return submaps_; }
  int64_t map_revision() const { return map_revision_; }
  const std::map<int64_t, link_t>& links() const { return links_; }  // by their number
  // True if every submap and link of the map has been told.
  bool complete() const { return heard_ && submaps_.size() >= submaps_in_all_ && links_.size() >= links_in_all_; }

 private:
  std::map<SubmapKey, submap_summary_t> submaps_;
  std::map<int64_t, link_t> links_;
  bool heard_ = false;
  int64_t map_revision_ = 0;
  size_t submaps_in_all_ = 0, links_in_all_ = 0;
};

}  // namespace rumi
