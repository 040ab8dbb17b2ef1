// SPDX-License-Identifier: BSD-3-Clause
// The folder into which a run writes, and run.json, which says what was run and marks the folder as ours.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/result.h"

namespace rumi::tool {

// Makes the folder. One that exists must hold an earlier run, or nothing that a run would overwrite; other files are
// left alone. An Error if the folder cannot be used.
Result<> check_output_folder(const std::string& folder);
// Does what check_output_folder() does, removes the report.html of an earlier run, and writes an unfinished run.json:
// that a folder cannot be written must be known before an hour of work.
Result<> prepare_output_folder(const std::string& folder);

// An Error if `database`, which a run only reads, is the map.db that the outputs would replace.
Result<> check_map_stays(const std::string& database, const std::string& folder);

// Returns null if the folder has no run.json, or if it is not one of rumi.
nlohmann::ordered_json read_run_json(const std::string& folder);

// Replaces run.json, and adds "program" and "version". An Error if it cannot be written.
Result<> write_run_json(const std::string& folder, const nlohmann::ordered_json& run);

// Converts options from the YAML of OptionTable::to_yaml() to JSON.
nlohmann::ordered_json options_to_json(const std::string& yaml);

}  // namespace rumi::tool
