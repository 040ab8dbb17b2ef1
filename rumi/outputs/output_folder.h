// SPDX-License-Identifier: BSD-3-Clause
// The folder that a run writes into, and run.json, which says what was run and marks the folder as ours.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/result.h"

namespace rumi::tool {

// Makes the folder, or finds that it holds an earlier run or nothing that a run would overwrite. Other files are left
// alone. An Error if the folder cannot be used.
Result<> check_output_folder(const std::string& folder);
// As check_output_folder(), and writes an unfinished run.json, so that a folder that cannot be written is known before
// an hour of work.
Result<> prepare_output_folder(const std::string& folder);

// An Error if `database`, which a run only reads, is the map.db that its outputs would replace.
Result<> check_map_stays(const std::string& database, const std::string& folder);

// Null if the folder has no run.json, or not one of rumi.
nlohmann::ordered_json read_run_json(const std::string& folder);

// Replaces run.json. "program" and "version" are added.
Result<> write_run_json(const std::string& folder, const nlohmann::ordered_json& run);

// Options as OptionTable::to_yaml gives them, as JSON.
nlohmann::ordered_json options_to_json(const std::string& yaml);

}  // namespace rumi::tool
