// SPDX-License-Identifier: BSD-3-Clause
// What earlier runs have left: their map, which the next run goes on with, and windows that wait in their spool.
#pragma once

#include <optional>
#include <string>

namespace rumi::tool {

// "300 frames of 2 earlier sessions". Nothing if there is none. Throws std::runtime_error, in map_server's words, if it
// cannot be read.
std::optional<std::string> describe_map_before(const std::string& database);

// Gives both other names, so that the next run begins anew. Returns the name that the map has now, empty if there was
// none. Nobody may have them open. Throws std::runtime_error with a message for the user.
std::string set_aside(const std::string& database, const std::string& spool);

}  // namespace rumi::tool
