// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/script.h"

#include <zlib.h>

#include <algorithm>

#include "bus/transfer/chunked_transfer.h"
#include "lcmtypes/rumi/chunk_t.hpp"

namespace rumi::fuzz {
namespace {

constexpr size_t kMostEvents = 48;  // longer inputs are cut, as a run should take only milliseconds
constexpr size_t kHeaderBytes = 3;
constexpr int64_t kBegin_us = 1'000'000;
constexpr int64_t kMessage_us = 20'000;  // time that passes after each message
constexpr int kLongestPause = 18;        // a pause is 2^n ms with n below this: 131 s at most
constexpr int kStepsToEnd = 3;

// Remembers the requests that the node sends to map_server, so that payloads can answer them.
class Requests {
 public:
  explicit Requests(MemoryBus& bus) {
    bus.subscribe<map_request_t>(channels::kMapRequest, {}, [this](const map_request_t& r) { asked_.push_back(r); });
  }
  const map_request_t* latest(size_t before) const {
    return asked_.empty() ? nullptr : &asked_[asked_.size() - 1 - before % asked_.size()];
  }

 private:
  std::vector<map_request_t> asked_;
};

void send_payload(const Stage& stage, View bytes, const Requests& requests, int64_t transfer_id) {
  if (bytes.size() < 2 || bytes.size() - 2 > static_cast<size_t>(kMaxChunkBytes)) return;
  chunk_t chunk{};
  chunk.utime = stage.bus->now_us();
  chunk.sender = "somebody";
  if (const map_request_t* request = requests.latest(bytes[1])) {
    chunk.receiver = request->requester;
    chunk.request_id = request->request_id;
  }
  chunk.transfer_id = transfer_id;
  chunk.kind = static_cast<int8_t>(bytes[0]);
  chunk.count = 1;
  chunk.data.assign(bytes.begin() + 2, bytes.end());
  chunk.total_size = chunk.size = static_cast<int32_t>(chunk.data.size());
  chunk.checksum = static_cast<int64_t>(crc32_z(0, chunk.data.data(), chunk.data.size()));
  stage.bus->publish(stage.chunk_channel, chunk);
}

void pass(const Stage& stage, int64_t time_us) {
  stage.bus->set_now_us(stage.bus->now_us() + time_us);
  stage.bus->dispatch();
  stage.node->tick(stage.bus->now_us());
  stage.bus->dispatch();
  end_step();
}

}  // namespace

Script parse_script(View input) {
  Script script;
  while (input.size() >= kHeaderBytes && script.size() < kMostEvents) {
    const size_t length = std::min<size_t>(input[1] | input[2] << 8, input.size() - kHeaderBytes);
    const View bytes = input.subspan(kHeaderBytes, length);
    script.push_back({input[0], {bytes.begin(), bytes.end()}});
    input = input.subspan(kHeaderBytes + length);
  }
  return script;
}

Bytes to_bytes(const Script& script) {
  Bytes bytes;
  for (const Event& event : script) {
    const size_t length = std::min<size_t>(event.bytes.size(), UINT16_MAX);
    bytes.insert(bytes.end(), {event.kind, static_cast<uint8_t>(length), static_cast<uint8_t>(length >> 8)});
    bytes.insert(bytes.end(), event.bytes.begin(), event.bytes.begin() + static_cast<ptrdiff_t>(length));
  }
  return bytes;
}

void play(const Script& script, const Stage& stage) {
  stage.bus->set_now_us(kBegin_us);
  const Requests requests(*stage.bus);
  int64_t transfer_id = 0;
  bool finished = false;
  for (const Event& event : script) {
    int64_t time_us = kMessage_us;
    const uint8_t first = event.bytes.empty() ? 0 : event.bytes[0];
    if (event.kind < Event::kFirstOther) {
      stage.bus->publish_raw(stage.channels[event.kind % stage.channels.size()], event.bytes);
    } else if (event.kind == Event::kTime) {
      time_us = int64_t{1000} << first % kLongestPause;
    } else if (event.kind == Event::kPayload && !stage.chunk_channel.empty()) {
      send_payload(stage, event.bytes, requests, ++transfer_id);
    } else if (event.kind == Event::kPicture && stage.picture) {
      stage.picture(*stage.bus, first);
    } else if (event.kind == Event::kFinish && !std::exchange(finished, true)) {
      stage.node->finish();
    }
    pass(stage, time_us);
  }
  stage.node->status();
  if (stage.finish && !finished) stage.node->finish();
  for (int i = 0; i < kStepsToEnd; ++i) pass(stage, kBegin_us);
}

}  // namespace rumi::fuzz
