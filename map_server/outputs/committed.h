// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/files/whole_file.h"
#include "base/result.h"

namespace rumi::map_server {

// Ends a file. An Error names it and says why it cannot be written.
inline Result<> committed(WholeFile* file) {
  if (const std::string problem = file->commit(); !problem.empty()) return Error{problem};
  return {};
}

}  // namespace rumi::map_server
