// SPDX-License-Identifier: BSD-3-Clause
// The results of a run, in run.json and on the terminal.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "rumi/outputs/map_file.h"

namespace rumi::tool {

// Adds `missing` (a line for each output that could not be written) to run.json, so that `rumi report` does not expect
// these files. Returns the lines as one sentence for a person; empty if nothing is missing.
std::string note_missing(const std::vector<std::string>& missing, const std::string& folder,
                         nlohmann::ordered_json* run);

nlohmann::ordered_json counts_to_json(const AtlasCounts& counts);
// Prints the results for a person: the counts, `notes` (see notes_of()), the parts that were left out, one line each,
// and the files.
void print_summary(const AtlasCounts& counts, const std::vector<std::string>& notes,
                   const std::vector<std::string>& left_out, const std::string& folder);

}  // namespace rumi::tool
