// SPDX-License-Identifier: BSD-3-Clause
// The whole ruminator: job, builder, and back submap on the bus.
#include <gmock/gmock.h>

#include "bus/wire/submap_update.h"
#include "tests/ruminator/ruminator_node_fixture.h"

namespace rumi::ruminator {
namespace {

using ::testing::HasSubstr;
using testing::RuminatorNodeTest;

class RebuildingNodeTest : public RuminatorNodeTest {
 protected:
  RebuildingNodeTest() { options_.rebuild = true; }
  void start_with_map_server() {
    receiver_.emplace(bus_, channels::kSubmap, channels::kSubmapAck, "map_server", true,
                      [this](const ChunkReceiver::Payload& payload) {
                        EXPECT_TRUE(Bus::decode(payload.bytes, &submaps_.emplace_back()));
                        return ChunkReceiver::Verdict{true, "", submaps_.back().revision};
                      });
    start();
  }
  std::vector<int> states() const {
    std::vector<int> states;
    for (const window_t& w : announced_)
      if (states.empty() || states.back() != w.state) states.push_back(w.state);
    return states;
  }
  std::optional<ChunkReceiver> receiver_;
  std::vector<submap_update_t> submaps_;
};

TEST_F(RebuildingNodeTest, ALossEndsInABackSubmap) {
  start_with_map_server();
  frames(100, 1);
  frames(20, kNoSubmap);
  frames(60, 2);
  EXPECT_THAT(states(), ::testing::ElementsAre(window_t::COLLECTING, window_t::QUEUED, window_t::EXTRACTING,
                                               window_t::MATCHING, window_t::MAPPING, window_t::PUBLISHED));
  ASSERT_EQ(submaps_.size(), 1);
  EXPECT_EQ(submaps_[0].submap_id, -1);
  EXPECT_EQ(submaps_[0].session, 7);
  EXPECT_EQ(submaps_[0].kind, submap_update_t::BACK);
  EXPECT_THAT(node_->status().detail, HasSubstr("1 published"));
}

TEST_F(RebuildingNodeTest, WhatIsOpenAtTheEndIsRebuiltToo) {
  start_with_map_server();
  frames(100, 1);
  frames(20, kNoSubmap);
  node_->finish();
  bus_.dispatch();
  EXPECT_TRUE(node_->finished());
  EXPECT_EQ(submaps_.size(), 1);
  EXPECT_EQ(announced_.back().state, window_t::PUBLISHED);
}

TEST_F(RebuildingNodeTest, StoppedInALossItLeavesTheWindowInTheSpool) {
  const testing::TemporaryFolder folder;
  options_.spool = folder / "spool";
  options_.build_thread = true;
  start_with_map_server();
  frames(100, 1);
  frames(20, kNoSubmap);
  node_->stop();
  for (int i = 0; i < 1000 && !node_->finished(); ++i) node_->tick(now_);
  EXPECT_TRUE(node_->finished());
  EXPECT_TRUE(submaps_.empty());
  EXPECT_TRUE(read_window_job(folder / "spool/7-1.window").has_value());
}

TEST_F(RebuildingNodeTest, WindowsOfAnEarlierProcessAreRebuiltAndTheirNumbersNotUsedAgain) {
  const testing::TemporaryFolder folder;
  options_.spool = folder / "spool";
  ASSERT_TRUE(Spool::open(options_.spool, 1'000'000).value()->add(testing::small_job(3, 7)));
  start_with_map_server();
  frames(30, 1);
  frames(20, kNoSubmap);
  frames(60, 2);
  ASSERT_EQ(submaps_.size(), 2);
  EXPECT_EQ(submaps_[0].submap_id, -3);
  EXPECT_EQ(submaps_[1].submap_id, -4);
}

TEST_F(RebuildingNodeTest, WithoutCalibrationItSaysWhatToDo) {
  start_with_map_server();
  for (int i = 0; i < 150; ++i) {
    next();
    image_t image = make_image(now_);
    image.metadata.clear();
    image.nmetadata = 0;
    bus_.publish(channels::kCamera, image);
    send_track(now_, i < 50 ? 1 : i < 60 ? kNoSubmap : 2, i % 5 == 0);
    bus_.dispatch();
    node_->tick(now_);
    bus_.dispatch();
  }
  EXPECT_EQ(announced_.back().state, window_t::FAILED);
  EXPECT_THAT(announced_.back().reason, HasSubstr("ruminator.camera_file"));
  EXPECT_TRUE(submaps_.empty());
}

}  // namespace
}  // namespace rumi::ruminator
