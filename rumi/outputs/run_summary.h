// SPDX-License-Identifier: BSD-3-Clause
// The progress of a run, and at its end the parts that its map lacks and why, for a person.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "map_server/atlas/atlas.h"
#include "rumi/outputs/map_file.h"
#include "rumi/outputs/masks.h"

namespace rumi::tool {

// "512 of 1000 images, 81.3 per second, about 6 s left". total: -1 if nobody knows.
std::string describe_progress(int64_t images, int64_t total, double elapsed_s);

// Frames without a pose, and submaps that are not part of the map, of the sessions after that one, a line each. Empty
// if there are none.
std::vector<std::string> left_out(const map_server::Atlas& atlas, int64_t after = map_server::kNoSession);

// Says whether a run found its place in the map of earlier sessions; empty if there was no such map. `after_s`: from
// its first submap to the first frame that did; negative if unknown.
std::string describe_localization(const AtlasCounts& counts, double after_s);

// Notes on a whole run, a line each: describe_localization(), and the parts of the images that never move.
std::vector<std::string> notes_of(const AtlasCounts& counts, double after_s, const RunMasks& masks);

}  // namespace rumi::tool
