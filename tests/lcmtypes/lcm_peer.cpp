// SPDX-License-Identifier: BSD-3-Clause
// Uses LCM's own library, to test that it reads what our Python module writes, and the other way round.
//   lcm_peer echo            sends messages on TO_CPP back on FROM_CPP, until a message comes on END
//   lcm_peer url             prints the LCM URL of Rumi's programs
//   lcm_peer copy LOG TO     reads a log and writes its events into another one
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <string>

#include "bus/process/process.h"

namespace {

class Echo {
 public:
  int run() {
    lcm::LCM& bus = bus_;
    if (!bus.good()) return 1;
    bus.subscribe("TO_CPP", &Echo::on_message, this)->setQueueCapacity(0);
    bus.subscribe("END", &Echo::on_end, this);
    std::puts("ready");
    std::fflush(stdout);
    while (!ended_)
      if (bus.handle() != 0) return 1;
    return 0;
  }

 private:
  void on_message(const lcm::ReceiveBuffer* buffer, const std::string&) {
    bus_.publish("FROM_CPP", buffer->data, buffer->data_size);
  }
  void on_end(const lcm::ReceiveBuffer*, const std::string&) { ended_ = true; }

  lcm::LCM bus_;
  bool ended_ = false;
};

int copy(const char* from, const char* to) {
  lcm::LogFile in(from, "r"), out(to, "w");
  if (!in.good() || !out.good()) return 1;
  while (const lcm::LogEvent* event = in.readNextEvent()) {
    lcm::LogEvent copied = *event;
    if (out.writeEvent(&copied) != 0) return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "echo") return Echo().run();
  if (what == "url") return std::puts(rumi::kDefaultLcmUrl) < 0;
  return what == "copy" && argc == 4 ? copy(argv[2], argv[3]) : 2;
}
