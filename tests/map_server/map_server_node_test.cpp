// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/map_server_node.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "bus/wire/pose.h"
#include "tests/map_server/map_server_node_fixture.h"

namespace rumi::map_server {
namespace {

using testing::expect_same;
using ::testing::HasSubstr;
using testing::kKey;
using testing::make_submap;
using testing::make_track;
using testing::MapServerNodeTest;
using testing::SubmapMaker;

TEST_F(MapServerNodeTest, StoresBeforeItAcknowledges) {
  const Submap submap = make_submap(kKey, 1, 5);
  const TransferResult result = send_and_wait(make_submap_update(submap, 0));
  EXPECT_TRUE(result.ok) << result.reason;
  EXPECT_EQ(result.revision, 5);
  EXPECT_EQ(node_->store().stored_revision(kKey), 5);
  expect_same(node_->atlas(), node_->store().load().value());
}

TEST_F(MapServerNodeTest, ChunkLossOfAThirdCostsTimeOnly) {
  lose(0.3);
  SubmapMaker maker(kKey, 1);
  int64_t stored = 0;
  for (int i = 0; i < 15; ++i) {
    maker.step();
    const TransferResult result = send_and_wait(make_submap_update(maker.submap(), stored), 30);
    ASSERT_TRUE(result.ok) << result.reason;
    stored = result.revision;
    ASSERT_EQ(stored, maker.submap().revision);
  }
  Atlas expected;
  testing::update_atlas(&expected, maker.submap());
  const Submap& got = node_->atlas().find(kKey)->submap;
  EXPECT_EQ(got.landmarks.size(), maker.submap().landmarks.size());
  EXPECT_EQ(got.keyframes.size(), maker.submap().keyframes.size());
  for (const auto& [id, landmark] : maker.submap().landmarks) {
    ASSERT_NE(got.landmark(id), nullptr);
    EXPECT_EQ(got.landmark(id)->position, landmark.position);
    EXPECT_EQ(got.landmark(id)->observations.size(), landmark.observations.size());
  }
  expect_same(node_->atlas(), node_->store().load().value());
}

TEST_F(MapServerNodeTest, AnUpdateFromBeyondIsSentBackToWhatIsStored) {
  SubmapMaker maker(kKey, 1);
  maker.step();
  ASSERT_TRUE(send_and_wait(make_submap_update(maker.submap(), 0)).ok);
  for (int i = 0; i < 3; ++i) maker.step();
  const TransferResult result = send_and_wait(make_submap_update(maker.submap(), 3));
  EXPECT_FALSE(result.ok);
  EXPECT_THAT(result.reason, HasSubstr("base_revision"));
  EXPECT_EQ(result.revision, 1);
  const TransferResult again = send_and_wait(make_submap_update(maker.submap(), result.revision));
  EXPECT_TRUE(again.ok) << again.reason;
  EXPECT_EQ(again.revision, 4);
}

TEST_F(MapServerNodeTest, OldAndRepeatedUpdatesChangeNothing) {
  SubmapMaker maker(kKey, 1);
  maker.step();
  const submap_update_t first = make_submap_update(maker.submap(), 0);
  maker.step();
  const submap_update_t second = make_submap_update(maker.submap(), 1);
  ASSERT_TRUE(send_and_wait(first).ok);
  ASSERT_TRUE(send_and_wait(second).ok);
  const Submap before = node_->atlas().find(kKey)->submap;
  const int64_t revision = node_->atlas().revision();
  for (const submap_update_t* update : {&first, &second, &first}) {
    const TransferResult result = send_and_wait(*update);
    EXPECT_TRUE(result.ok);
    EXPECT_EQ(result.revision, 2);
  }
  expect_same(before, node_->atlas().find(kKey)->submap);
  EXPECT_EQ(node_->atlas().revision(), revision);
}

TEST_F(MapServerNodeTest, NonsenseIsRejectedWithItsReasonAndHurtsNothing) {
  const Submap good = make_submap(kKey, 1, 3);
  ASSERT_TRUE(send_and_wait(make_submap_update(good, 0)).ok);
  const Submap before = node_->atlas().find(kKey)->submap;
  SubmapMaker maker(kKey, 1);
  for (int i = 0; i < 4; ++i) maker.step();

  submap_update_t bad = make_submap_update(maker.submap(), 3);
  bad.landmarks[0].position[1] = std::nan("");
  EXPECT_THAT(send_and_wait(bad).reason, HasSubstr("not finite"));
  bad = make_submap_update(maker.submap(), 3);
  bad.keyframes[0].cam_from_submap.quat[0] = std::nan("");
  EXPECT_THAT(send_and_wait(bad).reason, HasSubstr("keyframe"));
  bad = make_submap_update(maker.submap(), 3);
  bad.keyframes[0].landmark_id[0] = 4711;
  EXPECT_THAT(send_and_wait(bad).reason, HasSubstr("4711"));
  bad = make_submap_update(maker.submap(), 3);
  bad.calibration = "fx: nan";
  EXPECT_FALSE(send_and_wait(bad).ok);

  std::vector<uint8_t> bytes = encode_message(make_submap_update(maker.submap(), 3));
  bytes.resize(bytes.size() / 2);
  front_.send("", chunk_t::SUBMAP_UPDATE, 0, bytes, [this](const TransferResult& r) { results_.push_back(r); });
  front_.send("", chunk_t::DATABASE, 0, {1, 2, 3}, [this](const TransferResult& r) { results_.push_back(r); });
  pass(5);
  EXPECT_FALSE(results_[results_.size() - 1].ok);
  EXPECT_FALSE(results_[results_.size() - 2].ok);

  expect_same(before, node_->atlas().find(kKey)->submap);
  expect_same(node_->atlas(), node_->store().load().value());
  const TransferResult result = send_and_wait(make_submap_update(maker.submap(), 3));
  EXPECT_TRUE(result.ok) << result.reason;
}

TEST_F(MapServerNodeTest, ALandmarkThatNobodyObservesIsKept) {
  Submap submap = make_submap(kKey, 1, 2);
  submap.landmarks[900] = {};
  submap.landmarks[900].id = 900;
  submap.landmarks[900].revision = submap.revision;
  ASSERT_TRUE(send_and_wait(make_submap_update(submap, 0)).ok);
  ASSERT_NE(node_->atlas().find(kKey)->submap.landmark(900), nullptr);
  expect_same(node_->atlas(), node_->store().load().value());
}

TEST_F(MapServerNodeTest, StatusTellsTheWholeAtlasAtOneHertz) {
  bus_.publish(channels::kTrack, make_track(900'000, 7, track_t::NOT_INITIALIZED, kNoSubmap));
  Submap big = make_submap(kKey, 1, 4);
  ASSERT_TRUE(send_and_wait(make_submap_update(big, 0)).ok);
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap({7, 2}, 2, 2, 50'000'000), 0)).ok);
  statuses_.clear();
  pass(10);
  EXPECT_EQ(statuses_.size(), 10);
  const map_status_t& s = statuses_.back();
  EXPECT_EQ(s.frames, 1 + 16 + 8);
  EXPECT_EQ(s.frames_in_map, 16);
  EXPECT_GT(s.database_bytes, 10'000);
  EXPECT_EQ(s.map_revision, node_->atlas().revision());
  ASSERT_EQ(s.nsubmaps, 2);
  EXPECT_EQ(s.submaps[0].submap_id, 1);
  EXPECT_TRUE(s.submaps[0].in_map);
  EXPECT_FALSE(s.submaps[1].in_map);
  EXPECT_EQ(s.submaps[0].revision, 4);
  EXPECT_EQ(s.submaps[0].frames, 16);
  EXPECT_EQ(s.submaps[0].first_utime, big.frames.begin()->first);
  EXPECT_EQ(s.submaps[0].last_utime, big.frames.rbegin()->first);
  statuses_.clear();
  map_request_t request{};
  request.requester = "asker";
  request.what = map_request_t::STATUS;
  bus_.publish(channels::kMapRequest, request);
  bus_.dispatch();
  EXPECT_EQ(statuses_.size(), 1);
}

TEST_F(MapServerNodeTest, StatusTellsOfLinksAndPlacements) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 4), 0)).ok);
  place({kKey});
  EXPECT_TRUE(node_->atlas().set_links({{.a = kKey,
                                         .b = {7, 1},
                                         .kind = Link::Kind::kAppearance,
                                         .keyframes = 5,
                                         .keyframe_inliers = 4,
                                         .landmarks = 90,
                                         .landmark_inliers = 80,
                                         .rmse_px = 0.5,
                                         .doubt = "too good to be true"}}));
  statuses_.clear();
  pass(1.1);
  ASSERT_FALSE(statuses_.empty());
  const map_status_t& s = statuses_.back();
  EXPECT_EQ(s.submaps[0].placement_revision, node_->atlas().revision());
  EXPECT_EQ(from_wire(s.submaps[0].map_from_submap)->translation,
            node_->atlas().find(kKey)->placement.latest().translation);
  ASSERT_EQ(s.nlinks, 1);
  EXPECT_EQ(s.links[0].kind, link_t::APPEARANCE);
  EXPECT_EQ(s.links[0].submap_b, 1);
  EXPECT_EQ(s.links[0].landmark_inliers, 80);
  EXPECT_EQ(s.links[0].rmse_px, 0.5);
  EXPECT_FALSE(s.links[0].accepted);
  EXPECT_EQ(s.links[0].doubt, "too good to be true");
}

TEST_F(MapServerNodeTest, GarbageOnEveryChannelIsSurvived) {
  for (int i = 0; i < 2000; ++i) {
    std::vector<uint8_t> bytes(random_() % 300);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random_());
    for (const char* channel : {channels::kTrack, channels::kMapRequest, channels::kSubmap, channels::kMapAck})
      bus_.publish_raw(channel, bytes);
  }
  const std::vector<uint8_t> track = encode_message(make_track(1, 7, 9, 3));  // a state that does not exist
  for (size_t size = 0; size <= track.size(); ++size) bus_.publish_raw(channels::kTrack, std::span(track).first(size));
  pass(1);
  EXPECT_TRUE(node_->atlas().frames().empty());
  EXPECT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 2), 0)).ok);
}

// Sends valid messages with a few wrong bytes. Whatever passes the checks must leave a map that can be stored and read.
TEST_F(MapServerNodeTest, DamagedMessagesAreSurvived) {
  const Submap submap = make_submap(kKey, 1, 2);
  const std::vector<uint8_t> update = encode_message(make_submap_update(submap, 0));
  map_request_t ask_submap{};
  ask_submap.requester = "asker";
  ask_submap.session = kKey.session;
  ask_submap.submap_id = kKey.id;
  const std::vector<uint8_t> request = encode_message(ask_submap);
  const std::vector<uint8_t> track = encode_message(make_track(1, 7, track_t::TRACKING, 1));
  const auto damaged = [this](std::vector<uint8_t> bytes) {
    for (size_t i = 0; i < 1 + random_() % 4; ++i)
      bytes[8 + random_() % (bytes.size() - 8)] = static_cast<uint8_t>(random_());
    if (random_() % 4 == 0) bytes.resize(random_() % bytes.size());
    return bytes;
  };
  for (int i = 0; i < 1500; ++i) {
    front_.send("", chunk_t::SUBMAP_UPDATE, 0, damaged(update),
                [this](const TransferResult& r) { results_.push_back(r); });
    bus_.publish_raw(channels::kMapRequest, damaged(request));
    bus_.publish_raw(channels::kTrack, damaged(track));
    bus_.dispatch();
  }
  pass(100);
  EXPECT_EQ(results_.size(), 1500);
  EXPECT_TRUE(std::any_of(results_.begin(), results_.end(), [](const TransferResult& r) { return !r.ok; }));
  node_->finish();
  expect_same(node_->atlas(), node_->store().load().value());
  EXPECT_TRUE(send_and_wait(make_submap_update(make_submap({7, 77}, 1, 2), 0)).ok);
}

}  // namespace
}  // namespace rumi::map_server
