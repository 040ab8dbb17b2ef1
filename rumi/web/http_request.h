// SPDX-License-Identifier: BSD-3-Clause
// What a browser asks for, as far as a page that only shows something needs it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rumi::tool {

inline constexpr size_t kMaxHeadBytes = 8192;  // of a request; Chromium sends some 700

struct HttpRequest {
  std::string path;        // as asked for, without what follows a '?'
  bool keep_alive = true;  // the connection goes on after the answer
};

struct ReadRequest {
  // 0: more has to come. 200: *request is complete. Else the status that refuses it: the connection is to be closed.
  int status = 0;
  size_t bytes = 0;  // that a complete request took of the text
};

// Only GET without a body is taken, from a page of this computer: a name that somebody else's DNS points here (the
// header Host says which one was used) is refused.
ReadRequest read_request(std::string_view text, HttpRequest* request);

}  // namespace rumi::tool
