// SPDX-License-Identifier: BSD-3-Clause
// An lcm log as a recording, from the file to what camera_driver publishes. Byte 0 chooses the options.
#include "bus/transport/memory_bus.h"
#include "camera_driver/camera_node.h"
#include "camera_driver/open_source.h"
#include "fuzz/good_messages.h"
#include "fuzz/log_bytes.h"
#include "fuzz/scratch.h"

namespace rumi::fuzz {
namespace {

constexpr int kMostImages = 32;
constexpr int64_t kTick_us = 40'000;

void run(View input) {
  if (input.empty()) return;
  const std::string file = scratch().write("recording.lcm", input.subspan(1));
  camera_driver::CameraOptions options;
  options.loop = (input[0] & 1) != 0;
  options.encoding = (input[0] & 2) != 0 ? "rgb" : "auto";
  options.start_s = (input[0] & 4) != 0 ? 0.02 : 0;
  options.live_stamps = (input[0] & 8) != 0;
  options.rate_hz = (input[0] & 16) != 0 ? 30 : 0;
  camera_driver::OpenedSource opened = camera_driver::open_recording(file, options);
  if (!opened) return;
  MemoryBus bus;
  camera_driver::CameraNode node(bus, std::move(*opened), options);
  if ((input[0] & 32) != 0) {
    for (int i = 0; i < kMostImages && node.next_utime_us(); ++i) node.publish_next();
    return;
  }
  for (int i = 0; i < kMostImages && !node.done(); ++i) {
    bus.set_now_us(bus.now_us() + kTick_us);
    node.tick(bus.now_us());
  }
  node.status();
}

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  for (const uint8_t options : {0, 2, 1, 4 + 16, 8 + 32}) {
    LogBytes log;
    for (int i = 1; i < 5; ++i) log.add(channels::kCamera, i % 2 ? good_image(i * 10'000) : good_jpeg(i * 10'000));
    log.add("OTHER", good_image(7));
    Bytes& bytes = all.emplace_back(log.bytes());
    bytes.insert(bytes.begin(), options);
  }
  return all;
}

const Registered registered({"recording_log", run, seeds, mutate_log<1>});

}  // namespace
}  // namespace rumi::fuzz
