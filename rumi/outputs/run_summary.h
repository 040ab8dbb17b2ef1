// SPDX-License-Identifier: BSD-3-Clause
// Says how far a run is, and at its end what its map lacks and why, for a person.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "map_server/atlas/atlas.h"
#include "rumi/outputs/map_file.h"
#include "rumi/outputs/masks.h"

namespace rumi::tool {

// Returns "512 of 1000 images, 81.3 per second, about 6 s left". total: -1 if unknown.
std::string describe_progress(int64_t images, int64_t total, double elapsed_s);

// Returns a line on the frames without a pose, and one for each submap that is not part of the map, for the sessions
// after `after`. Empty if nothing is left out.
std::vector<std::string> left_out(const map_server::Atlas& atlas, int64_t after = map_server::kNoSession);

// Says whether a run found its place in the map of earlier sessions; empty if there was no such map. `after_s`: seconds
// from the first submap to the first frame that was localized; negative if unknown.
std::string describe_localization(const AtlasCounts& counts, double after_s);

// Returns notes on a whole run, one line each: describe_localization(), and the parts of the images that never move.
std::vector<std::string> notes_of(const AtlasCounts& counts, double after_s, const RunMasks& masks);

}  // namespace rumi::tool
