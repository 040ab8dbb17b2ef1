// SPDX-License-Identifier: BSD-3-Clause
// How a run goes, and at its end what its map lacks and why, for a person.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "map_server/atlas/atlas.h"

namespace rumi::tool {

// "512 of 1000 images, 81.3 per second, about 6 s left". total: -1 if nobody knows.
std::string describe_progress(int64_t images, int64_t total, double elapsed_s);

// What the map lacks, a line each: frames without a pose, and submaps that are not part of it. Empty if nothing.
std::vector<std::string> left_out(const map_server::Atlas& atlas);

}  // namespace rumi::tool
