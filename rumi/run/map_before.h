// SPDX-License-Identifier: BSD-3-Clause
// The map and the spool of earlier runs. The next run goes on with both.
#pragma once

#include <string>

#include "base/result.h"

namespace rumi::tool {

// "300 frames of 2 earlier sessions"; empty if there is no map. An Error, in map_server's words, if it cannot be read.
Result<std::string> describe_map_before(const std::string& database);

// Renames map and spool, so that the next run begins anew. Nobody may have them open. Returns the new name of the map,
// empty if there was no map. An Error if one cannot be renamed.
Result<std::string> set_aside(const std::string& database, const std::string& spool);

}  // namespace rumi::tool
