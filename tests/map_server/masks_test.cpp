// SPDX-License-Identifier: BSD-3-Clause
// The masks of the part that never moves, which map_server keeps from RUMI_MASK.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "tests/map_server/map_server_node_fixture.h"

namespace rumi::map_server {
namespace {

using testing::expect_same;
using ::testing::HasSubstr;
using testing::make_mask;
using testing::make_mask_message;
using testing::MapServerNodeTest;

constexpr int64_t kStream = 5;

class MasksTest : public MapServerNodeTest {
 protected:
  void publish(const mask_t& message) {
    bus_.publish(channels::kMask, message);
    bus_.dispatch();
  }
  void learn(int64_t stream, const StillMask& mask) { publish(make_mask_message(stream, mask)); }
};

TEST_F(MasksTest, TheNewestOfEachStreamIsKept) {
  learn(kStream, make_mask(7, 1'000'000, 8));
  learn(kStream, make_mask(7, 2'000'000, 12));
  learn(6, make_mask(7, 1'500'000, 4));
  learn(kStream, make_mask(7, 1'900'000, 20));  // older than the known one
  EXPECT_EQ(node_->atlas().masks(),
            (std::map<int64_t, StillMask>{{kStream, make_mask(7, 2'000'000, 12)}, {6, make_mask(7, 1'500'000, 4)}}));
  // The part turns out to move after all: a mask that leaves out nothing replaces the old one.
  learn(kStream, make_mask(7, 3'000'000, 0));
  EXPECT_EQ(node_->atlas().masks().at(kStream), make_mask(7, 3'000'000, 0));
}

// A mask that comes again every second must not be written again.
TEST_F(MasksTest, WhatIsSaidAgainIsStoredOnce) {
  learn(kStream, make_mask(7, 1'000'000, 8));
  pass(3);
  expect_same(node_->atlas(), node_->store().load().value());
  const int64_t changes = node_->store().changes();
  for (int second = 2; second < 9; ++second) {
    learn(kStream, make_mask(7, second * 1'000'000, 8));
    pass(2);
  }
  EXPECT_EQ(node_->store().changes(), changes);
  EXPECT_EQ(node_->atlas().masks().at(kStream).utime_us, 1'000'000) << "when it was learned so";
}

TEST_F(MasksTest, AMaskOfAnOlderRunIsNotTaken) {
  bus_.publish(channels::kTrack, testing::make_track(1'000'000, 7, track_t::TRACKING, 1));
  bus_.dispatch();
  learn(kStream, make_mask(6, 1'000'000, 8));
  EXPECT_TRUE(node_->atlas().masks().empty());
}

TEST_F(MasksTest, OfManyStreamsTheNewestAreKept) {
  for (int64_t stream = 1; stream <= 100; ++stream) learn(stream, make_mask(7, 1'000'000 * stream, 8));
  EXPECT_LT(node_->atlas().masks().size(), 100u);
  EXPECT_TRUE(node_->atlas().masks().contains(100));
  EXPECT_FALSE(node_->atlas().masks().contains(1));
  pass(3);
  expect_same(node_->atlas(), node_->store().load().value());
}

TEST_F(MasksTest, NonsenseIsRejectedAndHurtsNothing) {
  const mask_t good = make_mask_message(kStream, make_mask(7, 1'000'000, 8));
  publish(good);
  const auto known = node_->atlas().masks();
  int bad = 0;
  const auto publish_bad = [&](const auto& spoil) {
    mask_t message = make_mask_message(kStream, make_mask(7, 2'000'000, 12));
    spoil(&message);
    message.size = static_cast<int32_t>(message.png.size());
    publish(message);
    ++bad;
  };
  publish_bad([](mask_t* m) { m->stream = 0; });
  publish_bad([](mask_t* m) { m->width = -64; });
  publish_bad([](mask_t* m) { m->height = 1'000'000; });
  publish_bad([](mask_t* m) { m->width = 80; });
  publish_bad([](mask_t* m) { m->left_out = std::nan(""); });
  publish_bad([](mask_t* m) { m->left_out = -0.1; });
  publish_bad([](mask_t* m) { m->left_out = 1.1; });
  publish_bad([](mask_t* m) { m->left_out = 0; });
  publish_bad([](mask_t* m) { m->png.clear(); });
  publish_bad([](mask_t* m) { m->png.resize(m->png.size() / 2); });
  publish_bad([](mask_t* m) { m->png.assign(100, 'x'); });
  publish_bad([](mask_t* m) { m->png.resize(2'000'000); });
  publish_bad([](mask_t* m) {
    std::vector<uchar> jpeg;
    cv::imencode(".jpg", cv::Mat(48, 64, CV_8U, cv::Scalar(255)), jpeg);
    m->png.assign(jpeg.begin(), jpeg.end());
  });
  publish_bad([](mask_t* m) { m->png[19] = 65; });  // a width in the PNG's header that is not the message's
  EXPECT_EQ(node_->atlas().masks(), known);
  EXPECT_THAT(node_->status().detail, HasSubstr(fmt::format("{} rejected", bad)));
  pass(3);
  expect_same(node_->atlas(), node_->store().load().value());
}

TEST(Masks, AreThereAfterARestart) {
  const testing::TemporaryFolder folder;
  MapServerOptions options;
  options.database = folder / "map.db";
  const StillMask mask = make_mask(7, 1'000'000, 8);
  {
    MemoryBus bus;
    MapServerNode node(bus, options);
    bus.publish(channels::kMask, make_mask_message(kStream, mask));
    bus.dispatch();
    bus.set_now_us(2'000'000);  // masks are written within a second, so at most that is lost in a crash
    node.tick(bus.now_us());
  }
  MemoryBus bus;
  const MapServerNode successor(bus, options);
  EXPECT_EQ(successor.atlas().masks(), (std::map<int64_t, StillMask>{{kStream, mask}}));
}

TEST_F(MasksTest, AreInASnapshot) {
  learn(kStream, make_mask(7, 1'000'000, 8));
  ask(map_request_t::SNAPSHOT, 1);
  ASSERT_EQ(answers_.size(), 1u);
  const testing::TemporaryFolder folder;
  testing::write_file(folder / "answer.db", std::string(answers_[0].bytes.begin(), answers_[0].bytes.end()));
  expect_same(node_->atlas(), MapStore::open(folder / "answer.db").value().load().value());
}

}  // namespace
}  // namespace rumi::map_server
