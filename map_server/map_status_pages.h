// SPDX-License-Identifier: BSD-3-Clause
// Makes RUMI_MAP_STATUS for a map of any size, in pages: each page has the counts, and as many submaps and links as fit
// one datagram.
#pragma once

#include <map>
#include <set>

#include "lcmtypes/rumi/map_status_t.hpp"
#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

class MapStatusPages {
 public:
  // Returns the next page, without database_bytes, merging and localized_after_s, which the atlas does not know. If
  // everything fits one page, the page is complete. Otherwise up to half of its submaps are ones that have changed
  // since they were last on a page; the other submaps, and the links, take turns.
  map_status_t next(const Atlas& atlas, int64_t utime_us);

  // Begins a round: the pages that follow contain everything at least once, however many pages that takes.
  void begin_round();
  bool round_goes_on() const { return round_goes_on_; }

 private:
  struct Told {
    int64_t page = 0;
    int64_t revision = 0, placement_revision = 0;
    bool in_map = false;
  };
  std::set<SubmapKey> choose_submaps(const Atlas& atlas, size_t most) const;
  bool has_changed(const AtlasSubmap& owner, const Told& told) const;
  void add_links(const Atlas& atlas, int64_t room, map_status_t* page);
  bool all_is_told(const Atlas& atlas) const;

  std::map<SubmapKey, Told> told_;
  int64_t page_ = 0;         // number of the latest page
  int64_t round_begin_ = 0;  // number of the latest page when the round began
  size_t next_link_ = 0;
  bool round_goes_on_ = false, links_are_told_ = false;
};

}  // namespace rumi::map_server
