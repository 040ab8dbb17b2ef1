// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "map_server/atlas/atlas.h"
#include "map_server/outputs/colours.h"
#include "map_server/outputs/trajectory_file.h"

namespace rumi::map_server {

// Writes an atlas into a folder (creating it): trajectory.txt, frames.csv and submaps/NNN.txt of the sessions later
// than `after`, and map.ply of the whole map. Removes files of earlier runs in submaps/: those named like ours that
// were not written now. Writes all that can be written, and returns a line for each file that cannot.
std::vector<std::string> write_outputs(const Atlas& atlas, const std::string& folder, int64_t after = kNoSession,
                                       const LandmarkColours& colours = {});

}  // namespace rumi::map_server
