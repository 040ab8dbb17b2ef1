// SPDX-License-Identifier: BSD-3-Clause
// What a browser, or whoever reaches the port of `rumi web`, says: one request after another.
#include "rumi/web/http_request.h"

#include "fuzz/target.h"

namespace rumi::fuzz {
namespace {

void run(View input) {
  std::string text = to_text(input);
  for (;;) {
    tool::HttpRequest request;
    const tool::ReadRequest read = tool::read_request(text, &request);
    end_step();
    if (read.status != 200) return;
    if (read.bytes == 0 || read.bytes > text.size()) abort();  // it would be read for ever, or beyond its end
    text.erase(0, read.bytes);
  }
}

std::vector<Bytes> seeds() {
  return {to_bytes("GET /submap/1_-1?version=7 HTTP/1.1\r\nHost: localhost:8642\r\nAccept: */*\r\n\r\n"
                   "GET / HTTP/1.0\r\nhost: [::1]\r\nConnection: close\r\nContent-Length: 0\r\n\r\n"),
          to_bytes("POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\n")};
}

const Registered registered({"http_request", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
