// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>
#include <utility>

#include "slam/map/submap.h"

namespace rumi::map_server {

using Submaps = std::map<SubmapKey, const Submap*>;
using SubmapPair = std::pair<SubmapKey, SubmapKey>;  // the lower key first
using SubmapPairs = std::set<SubmapPair>;

}  // namespace rumi::map_server
