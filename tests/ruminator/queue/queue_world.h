// SPDX-License-Identifier: BSD-3-Clause
// A rebuild queue on a bus with a map_server, and its spool in a temporary folder.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bus/transport/memory_bus.h"
#include "lcmtypes/rumi/submap_update_t.hpp"
#include "ruminator/queue/rebuild_queue.h"
#include "tests/ruminator/test_jobs.h"
#include "tests/support/patience.h"

namespace rumi::testing {

inline constexpr int64_t kStepUs = 20'000;

// A bus with a map_server that stores every back submap, unless it is told to refuse or not to answer.
class World {
 public:
  explicit World(const RebuildQueueOptions& options, Builder builder, RebuildQueue::BuiltHandler on_built = {}) {
    bus.set_now_us(1'000'000);
    bus.subscribe<window_t>(channels::kWindow, {}, [this](const window_t& w) { windows.push_back(w); });
    bus.set_tap([this](const std::string& channel, std::span<const uint8_t>) {
      return map_server_answers || channel != channels::kSubmapAck;
    });
    receiver.emplace(bus, channels::kSubmap, channels::kSubmapAck, "map_server", true,
                     [this](const ChunkReceiver::Payload& payload) { return on_payload(payload); });
    queue.emplace(bus, options, std::move(builder), std::move(on_built));
  }
  void tick() {
    bus.set_now_us(bus.now_us() + kStepUs);
    queue->tick(bus.now_us());
    bus.dispatch();
    receiver->tick(bus.now_us());
    bus.dispatch();
  }
  void run_for(double seconds) {
    for (const int64_t end = bus.now_us() + static_cast<int64_t>(seconds * 1e6); bus.now_us() < end;) tick();
  }
  // Waits in real time, because the builder's thread runs in real time.
  bool run_until(const std::function<bool()>& condition) {
    return happens(condition, [this] { tick(); });
  }
  std::vector<int> states_of(int32_t id) const {  // states in order, without repetitions
    std::vector<int> states;
    for (const window_t& w : windows)
      if (w.window_id == id && (states.empty() || states.back() != w.state)) states.push_back(w.state);
    return states;
  }
  bool announced(int32_t id, int8_t state) const {
    return std::any_of(windows.begin(), windows.end(),
                       [&](const window_t& w) { return w.window_id == id && w.state == state; });
  }

  MemoryBus bus;
  std::vector<window_t> windows;
  std::vector<int32_t> received;  // ids of the submaps received
  bool map_server_answers = true;
  std::string refusal;
  std::function<void()> on_submap;
  std::optional<ChunkReceiver> receiver;
  std::optional<RebuildQueue> queue;

 private:
  ChunkReceiver::Verdict on_payload(const ChunkReceiver::Payload& payload) {
    submap_update_t update;
    EXPECT_TRUE(Bus::decode(payload.bytes, &update));
    EXPECT_EQ(update.kind, submap_update_t::BACK);
    if (on_submap) on_submap();
    if (!refusal.empty()) return {false, refusal, 0};
    received.push_back(update.submap_id);
    return {true, "", update.revision};
  }
};

class RebuildQueueTest : public ::testing::Test {
 protected:
  RebuildQueueTest() {
    options_.spool = folder_ / "spool";
    options_.build_thread = false;
    options_.retry_s = 2;
  }
  // Returns the names of the files in the spool, without ids.
  std::vector<std::string> left() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "spool"))
      if (entry.is_regular_file() && entry.path().extension() != ".id") names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  TemporaryFolder folder_;
  RebuildQueueOptions options_;
};

inline const std::vector<int> kWholeLife = {window_t::QUEUED, window_t::EXTRACTING, window_t::MATCHING,
                                            window_t::MAPPING, window_t::PUBLISHED};

}  // namespace rumi::testing
