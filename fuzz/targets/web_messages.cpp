// SPDX-License-Identifier: BSD-3-Clause
// The messages that `rumi web` receives while a page is open, and the answers that it makes from them.
#include "base/text/json_text.h"
#include "fuzz/good_messages.h"
#include "rumi/web/live_image.h"
#include "rumi/web/live_map.h"

namespace rumi::fuzz {
namespace {

enum Channel : uint8_t { kCamera, kTrack, kStatus, kChunk };

class Page : public Node {
 public:
  explicit Page(Bus& bus) : map_(bus), image_(bus) { image_.set_watched(true); }
  void tick(int64_t now_us) override {
    map_.tick(now_us, true);
    json_text(map_.pose());
    image_.jpeg(now_us);
  }
  NodeStatus status() override { return {}; }

 private:
  tool::LiveMap map_;
  tool::LiveImage image_;
};

void run(View input) {
  MemoryBus bus;
  Page page(bus);
  play(parse_script(input),
       {.bus = &bus,
        .node = &page,
        .channels = {channels::kCamera, channels::kTrack, channels::kMapStatus, channels::kMapChunk},
        .chunk_channel = channels::kMapChunk,
        .finish = false});
}

std::vector<Bytes> seeds() {
  const SubmapKey front{kSession, 1}, back{kSession, -1};
  const auto update = [](SubmapKey key) {
    return payload(chunk_t::SUBMAP_UPDATE, make_submap_update(good_submap(key, 2), 0));
  };
  const Script script{message(kTrack, good_track(kSession + 100'000, track_t::TRACKING, 1)),
                      message(kCamera, good_jpeg(kSession + 100'000)),
                      message(kStatus, good_status({front, back})),
                      pause(10),
                      update(back),
                      update(front),
                      pause(15),
                      message(kTrack, good_track(kSession + 200'000, track_t::LOST, 0)),
                      message(kCamera, good_image(kSession + 200'000)),
                      pause(15)};
  return {to_bytes(script)};
}

const Registered registered({"web_messages", run, seeds, mutate_script});

}  // namespace
}  // namespace rumi::fuzz
