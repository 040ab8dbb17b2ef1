// SPDX-License-Identifier: BSD-3-Clause
// The results of place search: the links that were found, and which keyframes have been searched for.
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
  // Accepted links, from the submap of the keyframe that was searched for (a) to that of the keyframe found (b).
  std::vector<LinkEdge> found;
  std::vector<LinkEdge> unconfirmed;   // links that no other link agrees with yet
  std::map<SubmapPair, Link> refused;  // the last refused link between two submaps, for the status and map.db

  std::set<std::pair<SubmapKey, int>> known;                 // keyframes that a search may find
  std::map<ImageId, std::vector<KeyframeRef>> searched_for;  // the keyframes that were searched for, by image
  // The revision of each submap when all its keyframes were searched for again.
  std::map<SubmapKey, int64_t> searched_again;
};

}  // namespace rumi::map_server
