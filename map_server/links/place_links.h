// SPDX-License-Identifier: BSD-3-Clause
// Places seen twice: what was searched for, and what was found.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "map_server/links/link_edge.h"
#include "map_server/links/submaps.h"

namespace rumi::map_server {

struct PlaceLinks {
  std::vector<LinkEdge> found;         // accepted. a: the submap of the keyframe searched for, b: of the one found
  std::vector<LinkEdge> unconfirmed;   // no other one agrees yet
  std::map<SubmapPair, Link> refused;  // the last one of each two, for whoever wonders

  std::set<std::pair<SubmapKey, int>> known;                 // keyframes that may be found
  std::map<ImageId, std::vector<KeyframeRef>> searched_for;  // the keyframes of each image that were
  std::map<SubmapKey, int64_t> searched_again;               // at this revision
};

}  // namespace rumi::map_server
