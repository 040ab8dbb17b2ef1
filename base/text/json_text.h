// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rumi {

// Returns JSON as text. Names of files and texts from elsewhere may hold bytes that are not UTF-8 (Latin-1, the disk of
// an old Windows), for which the library would throw: here U+FFFD replaces each of them. `indent` -1: all in one line.
template <class Json>
std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace rumi
