// SPDX-License-Identifier: BSD-3-Clause
// The folder that a run writes into, and run.json, which says what was run and marks the folder as ours.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rumi::tool {

// Makes the folder, or finds that it holds an earlier run or nothing that a run would overwrite. Other files are left
// alone. Returns what is wrong, or nothing.
std::string check_output_folder(const std::string& folder);
// The same, and puts an unfinished run.json there: what cannot be written is to be known before an hour of work, not
// after it.
std::string prepare_output_folder(const std::string& folder);

// The map that a run only reads must not be the map.db that its outputs put there. Returns what is wrong, or nothing.
std::string check_map_stays(const std::string& database, const std::string& folder);

// Null if there is none that is ours.
nlohmann::ordered_json read_run_json(const std::string& folder);

// Replaces run.json. "program" and "version" are added. Returns what is wrong, or nothing.
std::string write_run_json(const std::string& folder, const nlohmann::ordered_json& run);

// Options as OptionTable::to_yaml gives them, as JSON.
nlohmann::ordered_json options_to_json(const std::string& yaml);

}  // namespace rumi::tool
