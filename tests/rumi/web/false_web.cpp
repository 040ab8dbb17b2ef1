// SPDX-License-Identifier: BSD-3-Clause
// Serves the page of an imitated system to a browser. It prints its port and obeys the words on stdin, one per line
// (see obey()). The clock of the bus goes on as it serves.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <map>
#include <sstream>

#include "bus/transport/memory_bus.h"
#include "rumi/web/http_server.h"
#include "rumi/web/web_node.h"
#include "tests/rumi/web/false_system.h"

namespace rumi::tool {
namespace {

constexpr int kStepMs = 10;

class FalseWeb {
 public:
  FalseWeb() {
    bus_.set_now_us(20'000'000);
    std::printf("%d\n", server_.port());
    std::fflush(stdout);
  }
  void step() {
    bus_.set_now_us(bus_.now_us() + 1000 * kStepMs);
    if (alive_ && ++steps_ % 100 == 0) system_.publish_statuses();
    if (alive_ && steps_ % 10 == 0) system_.publish_image();
    bus_.dispatch();
    system_.tick();
    node_.tick(bus_.now_us(), server_.listeners() > 0);
    server_.serve(kStepMs);
  }
  void obey(const std::string& word) {
    const std::map<std::string, std::function<void()>> known = {
        {"track", [this] { system_.publish_tracks(); }},  {"map", [this] { system_.publish_map(); }},
        {"window", [this] { system_.publish_window(); }}, {"grow", [this] { system_.grow(2); }},
        {"lose", [this] { system_.publish_loss(); }},     {"live", [this] { alive_ = true; }},
        {"silence", [this] { alive_ = false; }},
    };
    known.at(word)();
  }

 private:
  MemoryBus bus_;
  FalseSystem system_{bus_};
  HttpServer server_{0, [this](const std::string& path) { return node_.answer(path); }};
  WebNode node_{bus_, PageFiles(RUMI_SOURCE_DIR "/rumi/web/page"), "a bus in memory",
                [this](const std::string& event, const std::string& data) { server_.tell(event, data); }};
  bool alive_ = false;
  int steps_ = 0;
};

// Runs until stdin is closed.
void run() {
  FalseWeb web;
  fcntl(STDIN_FILENO, F_SETFL, O_NONBLOCK);
  char bytes[256];
  for (ssize_t n = 0; (n = read(STDIN_FILENO, bytes, sizeof(bytes))) != 0; web.step()) {
    if (n < 0) continue;
    std::istringstream words(std::string(bytes, static_cast<size_t>(n)));
    for (std::string word; words >> word;) web.obey(word);
  }
}

}  // namespace
}  // namespace rumi::tool

int main() {
  rumi::tool::run();
  return 0;
}
