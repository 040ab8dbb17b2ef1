// SPDX-License-Identifier: BSD-3-Clause
// Groups of submaps: unite() joins the groups of two submaps.
#pragma once

#include <cstddef>
#include <map>

#include "slam/map/submap.h"
#include "slam/numeric/union_find.h"

namespace rumi::map_server {

class Groups {
 public:
  void unite(SubmapKey a, SubmapKey b) { groups_.unite(index(a), index(b)); }
  size_t find(SubmapKey key) { return groups_.find(index(key)); }

 private:
  size_t index(SubmapKey key) {
    const auto [known, is_new] = index_.try_emplace(key, index_.size());
    if (is_new) groups_.add();
    return known->second;
  }

  std::map<SubmapKey, size_t> index_;
  UnionFind groups_;
};

}  // namespace rumi::map_server
