// SPDX-License-Identifier: BSD-3-Clause
// What a run says about itself, in run.json and on the terminal.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "rumi/outputs/map_file.h"

namespace rumi::tool {

// Notes in run.json what could not be written, a line each: `rumi report` goes without it. Returns it as one sentence
// for a person; empty where nothing is missing.
std::string note_missing(const std::vector<std::string>& missing, const std::string& folder,
                         nlohmann::ordered_json* run);

nlohmann::ordered_json counts_to_json(const AtlasCounts& counts);
// For a person, what came out, `notes` (a line each): whether the map of before was found (describe_localization()) and
// what never moves in the images (describe_masks()), then what was left out (a line each) and where everything is.
void print_summary(const AtlasCounts& counts, const std::vector<std::string>& notes,
                   const std::vector<std::string>& left_out, const std::string& folder);

}  // namespace rumi::tool
