// SPDX-License-Identifier: BSD-3-Clause
// Messages to viewer_offscreen: images, tracked frames, the state of the map, and submaps as answers to its requests.
// It draws a picture only when enough time of the bus has passed, as a picture costs as much as hundreds of messages.
#include "bus/process/safe_node.h"
#include "fuzz/good_messages.h"
#include "viewer_offscreen/viewer_node.h"

namespace rumi::fuzz {
namespace {

enum Channel : uint8_t { kCamera, kTrack, kStatus, kChunk };

void run(View input) {
  MemoryBus bus;
  viewer_offscreen::ViewerOptions options;
  options.interval_s = 30;
  SafeNode node(std::make_unique<viewer_offscreen::ViewerNode>(bus, options), &bus.broken_handlers());
  const Stage stage{.bus = &bus,
                    .node = &node,
                    .channels = {channels::kCamera, channels::kTrack, channels::kMapStatus, channels::kMapChunk},
                    .chunk_channel = channels::kMapChunk,
                    .finish = false};
  play(parse_script(input), stage);
}

std::vector<Bytes> seeds() {
  const SubmapKey front{kSession, 1}, back{kSession, -1};
  const auto update = [](SubmapKey key) {
    return payload(chunk_t::SUBMAP_UPDATE, make_submap_update(good_submap(key, 2), 0));
  };
  Script one{message(kCamera, good_image(kSession + 100'000)),
             message(kTrack, good_track(kSession + 100'000, track_t::TRACKING, 1)),
             message(kStatus, good_status({front})), pause(15), update(front)};
  Script drawn = one;
  drawn.push_back(pause(15));
  drawn.push_back(message(kTrack, good_track(kSession + 200'000, track_t::LOST, 0)));
  drawn.push_back(message(kCamera, good_jpeg(kSession + 200'000)));
  drawn.push_back(pause(17));
  Script two{message(kStatus, good_status({front, back})), pause(15), update(back), pause(12), update(front)};
  return {to_bytes(one), to_bytes(drawn), to_bytes(two)};
}

const Registered registered({"viewer_messages", run, seeds, mutate_script});

}  // namespace
}  // namespace rumi::fuzz
