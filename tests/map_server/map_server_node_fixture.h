// SPDX-License-Identifier: BSD-3-Clause
// map_server on a bus in memory, for tests of its answers.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "bus/transport/memory_bus.h"
#include "bus/wire/submap_update.h"
#include "map_server/map_server_node.h"
#include "tests/map_server/place_map.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::testing {

inline constexpr SubmapKey kKey{7, 1};

// map_server on a bus in memory, with a sender of submaps and an asker. Time passes in steps of 50 ms.
class MapServerNodeTest : public ::testing::Test {
 protected:
  explicit MapServerNodeTest(const std::function<void(MapServerOptions*)>& change = {}) {
    options_.database = ":memory:";
    options_.merge.enabled = false;  // merging is tested in merging_node_test.cpp
    if (change) change(&options_);
    node_ = std::make_unique<MapServerNode>(bus_, options_);
    bus_.subscribe<map_status_t>(channels::kMapStatus, {}, [this](const map_status_t& s) { statuses_.push_back(s); });
  }
  void pass(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 20); ++i) {
      bus_.set_now_us(bus_.now_us() + 50'000);
      bus_.dispatch();
      node_->tick(bus_.now_us());
      front_.tick(bus_.now_us());
      asker_.tick(bus_.now_us());
      bus_.dispatch();
    }
  }
  void send(const submap_update_t& update) {
    front_.send("", chunk_t::SUBMAP_UPDATE, 0, encode_message(update),
                [this](const TransferResult& result) { results_.push_back(result); });
  }
  TransferResult send_and_wait(const submap_update_t& update, double seconds = 5) {
    const size_t before = results_.size();
    send(update);
    pass(seconds);
    return results_.size() > before ? results_.back() : TransferResult{.reason = "no answer"};
  }
  void ask(int8_t what, int32_t id, SubmapKey key = kKey, int64_t base = 0) {
    map_request_t request{};
    request.requester = "asker";
    request.request_id = id;
    request.what = what;
    request.session = key.session;
    request.submap_id = key.id;
    request.base_revision = base;
    bus_.publish(channels::kMapRequest, request);
    pass(5);
  }
  void ask_region(int32_t id, const Eigen::Vector3d& center, double radius) {
    map_request_t request{};
    request.requester = "asker";
    request.request_id = id;
    request.what = map_request_t::REGION;
    std::copy_n(center.data(), 3, request.center);
    request.radius = radius;
    bus_.publish(channels::kMapRequest, request);
    pass(5);
  }
  void place(const std::vector<SubmapKey>& keys) {
    std::map<SubmapKey, Placement> placements;
    for (const SubmapKey key : keys) {
      const Submap& submap = node_->atlas().find(key)->submap;
      placements[key] = make_placement(submap, 3);
      placements[key].fused[submap.landmarks.rbegin()->first] = {key, submap.landmarks.begin()->first};
    }
    testing::place_map(&node_->atlas(), placements);
  }
  void lose(double share) {
    bus_.set_tap([this, share](const std::string&, std::span<const uint8_t>) {
      return std::uniform_real_distribution<double>(0, 1)(random_) >= share;
    });
  }

  MemoryBus bus_;
  MapServerOptions options_;
  std::unique_ptr<MapServerNode> node_;
  ChunkSender front_{bus_, channels::kSubmap, channels::kSubmapAck, "front_tracker@test:1", {.chunk_bytes = 2000}};
  std::vector<ChunkReceiver::Payload> answers_;
  ChunkReceiver asker_{
      bus_, channels::kMapChunk, channels::kMapAck, "asker", false, [this](const ChunkReceiver::Payload& payload) {
        answers_.push_back(payload);
        return ChunkReceiver::Verdict{};
      }};
  std::vector<TransferResult> results_;
  std::vector<map_status_t> statuses_;
  std::mt19937 random_{42};
};

}  // namespace rumi::testing
