// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "map_server/atlas/atlas.h"
#include "map_server/outputs/colours.h"
#include "map_server/outputs/trajectory_file.h"

namespace rumi::map_server {

// Writes an atlas into a folder (created): trajectory.txt, frames.csv and submaps/NNN.txt of sessions later than
// `after`, and map.ply of the whole map. Files in submaps/ that look like ours but were not written are removed: they
// are from an earlier run. It writes what can be written, and returns a line for each file that cannot.
std::vector<std::string> write_outputs(const Atlas& atlas, const std::string& folder, int64_t after = kNoSession,
                                       const LandmarkColours& colours = {});

}  // namespace rumi::map_server
