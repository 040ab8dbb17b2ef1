// SPDX-License-Identifier: BSD-3-Clause
// A map_server that can be restarted, a sender of submaps, and a chain of five submaps to send.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "bus/transport/memory_bus.h"
#include "bus/wire/pose.h"
#include "bus/wire/submap_update.h"
#include "lcmtypes/rumi/map_status_t.hpp"
#include "map_server/map_server_node.h"
#include "tests/map_server/synthetic_chain.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::testing {
using namespace rumi::map_server;

inline constexpr SubmapKey kFront1 = Chain::kFront1, kFront2 = Chain::kFront2, kFront3 = Chain::kFront3,
                           kBack1 = Chain::kBack1, kBack2 = Chain::kBack2;
inline const std::vector<SubmapKey> kAll = {kFront1, kBack1, kFront2, kBack2, kFront3};

// Time passes in steps of 50 ms.
class MergingNodeTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { chain_ = new Chain; }
  static void TearDownTestSuite() { delete chain_; }

  MergingNodeTest() {
    options_.database = ":memory:";
    options_.merge.thread = false;
  }
  // Starts a new process with the same database. Messages on the bus are lost.
  void start() {
    stop();
    side_ = std::make_unique<Side>();
    side_->bus.set_now_us(now_us_);
    node_ = std::make_unique<MapServerNode>(side_->bus, options_);
  }
  void stop() {
    node_.reset();
    side_.reset();
  }
  void step() {
    now_us_ += 50'000;
    side_->bus.set_now_us(now_us_);
    side_->bus.dispatch();
    node_->tick(now_us_);
    side_->maker.tick(now_us_);
    side_->asker.tick(now_us_);
    side_->bus.dispatch();
  }
  void pass(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 20); ++i) step();
  }
  TransferResult send(const submap_update_t& update) {
    std::optional<TransferResult> result;
    side_->maker.send("", chunk_t::SUBMAP_UPDATE, 0, encode_message(update),
                      [&](const TransferResult& r) { result = r; });
    for (int i = 0; i < 200 && !result; ++i) step();
    return result.value_or(TransferResult{.ok = false, .reason = "no answer"});
  }
  TransferResult send(SubmapKey key) { return send(make_submap_update(chain_->submap(key), 0)); }
  void send_all() {
    for (const SubmapKey key : kAll) ASSERT_TRUE(send(key).ok);
  }
  void ask_for(int8_t what, int32_t id = 1) {
    map_request_t request{};
    request.requester = "asker";
    request.request_id = id;
    request.what = what;
    side_->bus.publish(channels::kMapRequest, request);
    side_->bus.dispatch();
  }
  // Waits until the thread has finished its build, without letting time pass.
  void wait() {
    for (int64_t i = 0; i < 100'000'000; ++i) {
      ask_for(map_request_t::STATUS);
      if (!side_->status.merging) return;
      node_->tick(now_us_);
      std::this_thread::yield();
    }
  }
  // Lets time pass until the whole map has been adjusted.
  void settle() { pass(options_.merge.adjustment_interval_s + 5); }

  bool in_map(SubmapKey key) const {
    return std::any_of(side_->status.submaps.begin(), side_->status.submaps.end(), [key](const submap_summary_t& s) {
      return SubmapKey{s.session, s.submap_id} == key && s.in_map;
    });
  }
  int accepted_links() const {
    return static_cast<int>(std::count_if(side_->status.links.begin(), side_->status.links.end(),
                                          [](const link_t& l) { return l.accepted && l.kind == link_t::SAME_IMAGES; }));
  }
  void expect_one_map() const {
    ASSERT_EQ(side_->status.nsubmaps, 5);
    for (const submap_summary_t& s : side_->status.submaps) {
      EXPECT_TRUE(s.in_map) << s.submap_id;
      EXPECT_GT(s.placement_revision, 0) << s.submap_id;
      EXPECT_TRUE(from_wire(s.map_from_submap)) << s.submap_id;
    }
    EXPECT_EQ(accepted_links(), 4);
    EXPECT_EQ(side_->status.frames_in_map, Chain::kImages);
    EXPECT_EQ(side_->status.map_revision, node_->atlas().revision());
    EXPECT_LT(chain_->error(node_->atlas()).rmse, 0.04);
    expect_same(node_->atlas(), node_->store().load().value());
  }

  // The bus, and the other processes on it.
  struct Side {
    Side() {
      bus.subscribe<map_status_t>(channels::kMapStatus, {}, [this](const map_status_t& s) { status = s; });
    }
    MemoryBus bus;
    ChunkSender maker{bus, channels::kSubmap, channels::kSubmapAck, "front_tracker@test:1"};
    std::vector<ChunkReceiver::Payload> answers;
    ChunkReceiver asker{
        bus, channels::kMapChunk, channels::kMapAck, "asker", false, [this](const ChunkReceiver::Payload& payload) {
          answers.push_back(payload);
          return ChunkReceiver::Verdict{};
        }};
    map_status_t status{};
  };

  static inline Chain* chain_ = nullptr;
  MapServerOptions options_;
  int64_t now_us_ = 1'000'000;
  std::unique_ptr<Side> side_;
  std::unique_ptr<MapServerNode> node_;
};

}  // namespace rumi::testing
