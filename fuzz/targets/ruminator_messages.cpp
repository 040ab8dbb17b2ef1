// SPDX-License-Identifier: BSD-3-Clause
// Messages to ruminator: images, masks, and tracking that is lost and found again. A complete window is checked as one
// from a file would be; a stand-in takes the place of the rebuild.
#include "bus/process/safe_node.h"
#include "fuzz/good_messages.h"
#include "ruminator/ruminator_node.h"

namespace rumi::fuzz {
namespace {

using namespace ruminator;

enum Channel : uint8_t { kCamera, kTrack, kAck, kMask };
constexpr int64_t kFrame_us = 100'000;

BuildResult build(const WindowJob& job, const std::string&, const std::function<void(const BuildProgress&)>& progress,
                  const std::atomic<bool>&) {
  progress({.stage = BuildStage::kMapping, .fraction = 0.5, .remaining_s = 1});
  BuildResult result;
  if (!check_window_job(job) || job.images.size() % 2 == 0)
    result.submap = Error{"this one is to fail"};
  else
    result.submap = good_submap({job.window.session, -job.window.id}, 2);
  return result;
}

void run(View input) {
  MemoryBus bus;
  RuminatorOptions options;
  options.build_thread = false;
  options.spool.clear();
  options.ring_mb = 1;
  options.window.gap_max_frames = 8;
  SafeNode node(std::make_unique<RuminatorNode>(bus, options, RuminatorHooks{build, {}, {}, {}}),
                &bus.broken_handlers());
  const Stage stage{.bus = &bus,
                    .node = &node,
                    .channels = {channels::kCamera, channels::kTrack, channels::kSubmapAck, channels::kMask},
                    .chunk_channel = ""};
  play(parse_script(input), stage);
}

void add_frame(Script* script, int number, int8_t state, int32_t submap_id) {
  const int64_t utime_us = kSession + kFrame_us * number;
  script->push_back(message(kCamera, number % 3 ? good_jpeg(utime_us) : good_image(utime_us)));
  script->push_back(message(kTrack, good_track(utime_us, state, submap_id)));
}

std::vector<Bytes> seeds() {
  Script resumed, ended;
  for (int i = 0; i < 5; ++i) add_frame(&resumed, i, track_t::TRACKING, 1);
  for (int i = 5; i < 11; ++i) add_frame(&resumed, i, track_t::LOST, 0);
  resumed.push_back(message(kMask, good_mask(kSession + 10 * kFrame_us)));
  ended = resumed;
  for (int i = 11; i < 21; ++i) add_frame(&resumed, i, track_t::TRACKING, 2);
  resumed.push_back(pause(15));
  resumed.push_back(message(kAck, good_ack(1, chunk_ack_t::COMPLETE)));
  ended.push_back({Event::kFinish, {}});
  return {to_bytes(resumed), to_bytes(ended)};
}

const Registered registered({"ruminator_messages", run, seeds, mutate_script});

}  // namespace
}  // namespace rumi::fuzz
