// SPDX-License-Identifier: BSD-3-Clause
// Messages to map_server: updates of submaps, tracked frames, requests, acknowledgements and masks.
#include "bus/process/safe_node.h"
#include "fuzz/good_messages.h"
#include "map_server/map_server_node.h"

namespace rumi::fuzz {
namespace {

enum Channel : uint8_t { kTrack, kRequest, kSubmap, kAck, kMask };

void run(View input) {
  MemoryBus bus;
  map_server::MapServerOptions options;
  options.database = map_server::kInMemory;
  options.merge.thread = false;
  SafeNode node(std::make_unique<map_server::MapServerNode>(bus, options), &bus.broken_handlers());
  const Stage stage{
      .bus = &bus,
      .node = &node,
      .channels = {channels::kTrack, channels::kMapRequest, channels::kSubmap, channels::kMapAck, channels::kMask},
      .chunk_channel = channels::kSubmap};
  play(parse_script(input), stage);
}

std::vector<Bytes> seeds() {
  const auto update = [](SubmapKey key, int keyframes, int64_t base) {
    return payload(chunk_t::SUBMAP_UPDATE, make_submap_update(good_submap(key, keyframes), base));
  };
  const auto ask = [](int8_t what, SubmapKey key) { return message(kRequest, good_request(what, key)); };
  const SubmapKey front{kSession, 1}, next{kSession, 2}, back{kSession, -1};
  Script grows{update(front, 2, 0), message(kTrack, good_track(kSession + 100'000, track_t::TRACKING, 1)), pause(11),
               update(front, 3, 2), message(kTrack, good_track(kSession + 300'000, track_t::LOST, 0)),     pause(11)};
  Script asks{update(front, 3, 0), pause(12)};
  for (int8_t what = 0; what <= map_request_t::REGION; ++what) {
    asks.push_back(ask(what, front));
    asks.push_back(message(kAck, good_ack(what, chunk_ack_t::COMPLETE)));
  }
  Script joins{update(front, 4, 0),
               update(next, 4, 0),
               update(back, 4, 0),
               pause(12),
               ask(map_request_t::TRAJECTORY, front),
               pause(15),
               ask(map_request_t::PLACED_SUBMAP, back)};
  Script masks{message(kMask, good_mask(kSession + 100'000)), pause(11), message(kMask, good_mask(kSession + 900'000)),
               pause(11), ask(map_request_t::SNAPSHOT, front)};
  return {to_bytes(grows), to_bytes(asks), to_bytes(joins), to_bytes(masks)};
}

const Registered registered({"map_server_messages", run, seeds, mutate_script});

}  // namespace
}  // namespace rumi::fuzz
