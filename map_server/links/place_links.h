// SPDX-License-Identifier: BSD-3-Clause
// Places that were seen twice: the keyframes that were searched for, and the links that were found.
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
  std::vector<LinkEdge>
      found;  // accepted; a is the submap of the keyframe that was searched for, b that of the one found
  std::vector<LinkEdge> unconfirmed;   // links that no other link agrees with yet
  std::map<SubmapPair, Link> refused;  // the last refused link between two submaps, for the status and map.db

  std::set<std::pair<SubmapKey, int>> known;                 // keyframes that a search may find
  std::map<ImageId, std::vector<KeyframeRef>> searched_for;  // the keyframes that were searched for, by image
  std::map<SubmapKey, int64_t>
      searched_again;  // the revision of each submap when all its keyframes were searched for again
};

}  // namespace rumi::map_server
