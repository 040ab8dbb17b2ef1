// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/result.h"
#include "map_server/atlas/atlas.h"
#include "map_server/outputs/colours.h"

namespace rumi::map_server {

// Writes the served map as a binary PLY file: its landmarks, then the camera centres of all frames in white. An Error
// names the file if it cannot be written.
Result<> write_ply(const Atlas& atlas, const std::string& file, const LandmarkColours& colours = {});

}  // namespace rumi::map_server
