// SPDX-License-Identifier: BSD-3-Clause
// The map and the spool of earlier runs, with which the next run goes on.
#pragma once

#include <string>

#include "base/result.h"

namespace rumi::tool {

// Returns, for example, "300 frames of 2 earlier sessions"; empty if there is no map, or one without frames. If the map
// cannot be read, the Error is that of map_server.
Result<std::string> describe_map_before(const std::string& database);

// Renames the map and the spool, so that the next run begins anew. No process may have them open. Returns the new name
// of the map; empty if there was no map. An Error if one of them cannot be renamed.
Result<std::string> set_aside(const std::string& database, const std::string& spool);

}  // namespace rumi::tool
