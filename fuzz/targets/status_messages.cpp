// SPDX-License-Identifier: BSD-3-Clause
// The messages that `rumi status` hears.
#include "base/text/json_text.h"
#include "bus/wire/map_overview.h"
#include "fuzz/good_messages.h"
#include "lcmtypes/rumi/process_status_t.hpp"
#include "lcmtypes/rumi/window_t.hpp"
#include "rumi/run/live_status.h"

namespace rumi::fuzz {
namespace {

enum Channel : uint8_t { kStatus, kTrack, kMap, kWindow };

class Listener : public Node {
 public:
  explicit Listener(Bus& bus) : live_(bus) {
    bus.subscribe<map_status_t>(channels::kMapStatus, {}, [this](const map_status_t& status) { map_.take(status); });
  }
  void tick(int64_t) override {}
  NodeStatus status() override {
    map_.complete();
    json_text(live_.to_json(), 2);
    return {.detail = live_.to_text()};
  }

 private:
  tool::LiveStatus live_;
  MapOverview map_;
};

void run(View input) {
  MemoryBus bus;
  Listener listener(bus);
  play(parse_script(input), {.bus = &bus,
                             .node = &listener,
                             .channels = {channels::kStatus, channels::kTrack, channels::kMapStatus, channels::kWindow},
                             .chunk_channel = ""});
}

process_status_t good_process(int64_t utime_us) {
  process_status_t status{};
  status.utime = utime_us;
  status.process = "map_server";
  status.host = "here";
  status.detail = "all is well";
  status.messages_in = utime_us / 1000;
  status.cpu_s = 1e-6 * static_cast<double>(utime_us);
  status.channels.resize(1);
  status.channels[0] = {};
  status.channels[0].channel = "CAMERA";
  status.nchannels = 1;
  status.stages.resize(1);
  status.stages[0].stage = "map_server.save";
  status.stages[0].cpu_s = 1;
  status.nstages = 1;
  return status;
}

std::vector<Bytes> seeds() {
  window_t window{};
  window.session = kSession;
  window.window_id = 1;
  window.approach_utime = {1, 2};
  window.napproach = 2;
  const Script script{message(kStatus, good_process(1'000'000)),
                      message(kTrack, good_track(kSession, track_t::TRACKING, 1)),
                      message(kMap, good_status({{kSession, 1}, {kSession, -1}})),
                      message(kWindow, window),
                      pause(10),
                      message(kTrack, good_track(kSession + 100'000, track_t::LOST, 0)),
                      message(kStatus, good_process(2'000'000))};
  return {to_bytes(script)};
}

const Registered registered({"status_messages", run, seeds, mutate_script});

}  // namespace
}  // namespace rumi::fuzz
