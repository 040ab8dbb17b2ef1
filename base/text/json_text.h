// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rumi {

// JSON as text. Names of files, and what others say of themselves, may hold bytes that are no UTF-8 (a disk of an old
// Windows, Latin-1): the library would throw for them, here U+FFFD stands for each. indent -1: one line.
template <class Json>
std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace rumi
