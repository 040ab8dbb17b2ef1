// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/map_server_node.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>
#include <thread>

#include "bus/transport/memory_bus.h"
#include "bus/wire/map_overview.h"
#include "bus/wire/submap_update.h"
#include "lcmtypes/rumi/map_region_t.hpp"
#include "lcmtypes/rumi/trajectory_t.hpp"
#include "tests/map_server/test_atlas.h"

namespace rumi::map_server {
namespace {

using testing::expect_same;
using ::testing::HasSubstr;
using testing::make_submap;
using testing::make_track;
using testing::SubmapMaker;
using testing::TemporaryFolder;

constexpr SubmapKey kKey{7, 1};

// map_server on a bus in memory, with a front_tracker's sender and an asker beside it. Time passes in steps of 50 ms.
class MapServerNodeTest : public ::testing::Test {
 protected:
  explicit MapServerNodeTest(const std::function<void(MapServerOptions*)>& change = {}) {
    options_.database = ":memory:";
    options_.merge.enabled = false;  // see merging_node_test.cpp
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
      placements[key] = testing::make_placement(submap, 3);
      placements[key].fused[submap.landmarks.rbegin()->first] = {key, submap.landmarks.begin()->first};
    }
    node_->atlas().place_map(placements);
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

TEST_F(MapServerNodeTest, StoresBeforeItAcknowledges) {
  const Submap submap = make_submap(kKey, 1, 5);
  const TransferResult result = send_and_wait(make_submap_update(submap, 0));
  EXPECT_TRUE(result.ok) << result.reason;
  EXPECT_EQ(result.revision, 5);
  EXPECT_EQ(node_->store().stored_revision(kKey), 5);
  expect_same(node_->atlas(), node_->store().load());
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
  expect_same(node_->atlas(), node_->store().load());
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
  expect_same(node_->atlas(), node_->store().load());
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
  expect_same(node_->atlas(), node_->store().load());
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

TEST_F(MapServerNodeTest, AMapOfAnySizeIsToldInDatagramsAndWholeWhenAskedFor) {
  for (int id = 1; id <= 1000; ++id)
    node_->atlas().change_submap({7, id}, [id](Submap* submap) {
      submap->key = {7, id};
      submap->revision = 1;
      return std::string();
    });
  std::vector<Link> links;
  for (int i = 0; i < 5000; ++i) links.push_back({.a = {7, 1}, .b = {7, 2}, .doubt = std::string(100, 'x')});
  node_->atlas().set_links(std::move(links));
  size_t largest = 0;
  bus_.set_tap([&](const std::string& channel, std::span<const uint8_t> data) {
    if (channel == channels::kMapStatus) largest = std::max(largest, data.size());
    return true;
  });
  pass(3);
  EXPECT_LE(statuses_.size(), 4);
  MapOverview map;
  statuses_.clear();
  ask(map_request_t::STATUS, 3);
  for (const map_status_t& status : statuses_) map.take(status);
  EXPECT_TRUE(map.complete());
  EXPECT_EQ(map.submaps().size(), 1000);
  EXPECT_EQ(map.links().size(), 5000);
  EXPECT_LE(largest, 60'000);
}

TEST_F(MapServerNodeTest, AnswersWithASubmapOrWhatChangedInIt) {
  SubmapMaker maker(kKey, 1);
  for (int i = 0; i < 4; ++i) {
    maker.step();
    ASSERT_TRUE(send_and_wait(make_submap_update(maker.submap(), i)).ok);
  }
  lose(0.3);
  ask(map_request_t::SUBMAP, 11);
  pass(30);
  ask(map_request_t::SUBMAP, 12, kKey, 3);
  pass(30);
  ASSERT_EQ(answers_.size(), 2);
  EXPECT_EQ(answers_[0].request_id, 11);
  EXPECT_LT(answers_[1].bytes.size(), answers_[0].bytes.size());
  Submap copy;
  submap_update_t update;
  ASSERT_TRUE(Bus::decode(answers_[0].bytes, &update));
  ASSERT_EQ(apply_submap_update(update, &copy), "");
  EXPECT_EQ(copy.landmarks.size(), maker.submap().landmarks.size());
  EXPECT_EQ(copy.revision, 4);
  ASSERT_TRUE(Bus::decode(answers_[1].bytes, &update));
  EXPECT_EQ(update.base_revision, 3);
}

TEST_F(MapServerNodeTest, ASnapshotIsADatabaseWithEverythingHeardSoFar) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 6), 0)).ok);
  bus_.publish(channels::kTrack, make_track(900'000, 7, track_t::LOST, kNoSubmap));
  bus_.dispatch();
  ask(map_request_t::SNAPSHOT, 5);
  ASSERT_EQ(answers_.size(), 1);
  EXPECT_EQ(answers_[0].kind, chunk_t::DATABASE);
  const TemporaryFolder folder;
  testing::write_file(folder / "map.db", std::string(answers_[0].bytes.begin(), answers_[0].bytes.end()));
  MapStore store(folder / "map.db");
  const Atlas loaded = store.load();
  expect_same(node_->atlas(), loaded);
  EXPECT_EQ(loaded.frames().at({900'000}).state, TrackingState::kLost);
}

TEST_F(MapServerNodeTest, ASnapshotIsNotRefusedBecauseOthersAskALot) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 6), 0)).ok);
  map_request_t request{};
  request.requester = "viewer";  // takes its time
  request.what = map_request_t::SUBMAP;
  request.session = kKey.session;
  request.submap_id = kKey.id;
  for (int id = 1; id <= 10; ++id) {
    request.request_id = id;
    bus_.publish(channels::kMapRequest, request);
  }
  bus_.dispatch();
  ask(map_request_t::SUBMAP, 11);
  ask(map_request_t::SNAPSHOT, 12);
  ASSERT_EQ(answers_.size(), 2);
  EXPECT_EQ(answers_[0].kind, chunk_t::REFUSED) << "so many are under way";
  EXPECT_EQ(answers_[1].kind, chunk_t::DATABASE);
}

TEST_F(MapServerNodeTest, RefusesWithAReason) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 2), 0)).ok);
  ask(map_request_t::SUBMAP, 1, {7, 99});
  ask(map_request_t::SUBMAP, 2, kKey, 3);
  ask(77, 3);
  ASSERT_EQ(answers_.size(), 3);
  for (const auto& answer : answers_) EXPECT_EQ(answer.kind, chunk_t::REFUSED);
  const auto text = [this](int i) { return std::string(answers_[i].bytes.begin(), answers_[i].bytes.end()); };
  EXPECT_THAT(text(0), HasSubstr("no submap 99"));
  EXPECT_THAT(text(1), HasSubstr("base_revision 3"));
  EXPECT_THAT(text(2), HasSubstr("what = 77"));
}

TEST_F(MapServerNodeTest, AnswersWithTheMapAsItWasPlaced) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 4), 0)).ok);
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap({7, 2}, 2, 2, 50'000'000), 0)).ok);
  place({kKey});
  const AtlasSubmap& owner = *node_->atlas().find(kKey);
  ask(map_request_t::PLACED_SUBMAP, 1, kKey, 3);  // base_revision makes no difference
  ask(map_request_t::TRAJECTORY, 2);
  ask_region(3, {0, 0, 0}, 1e300);
  ask_region(4, {0.1, 0.2, 0.3}, 3);
  ASSERT_EQ(answers_.size(), 4);
  submap_update_t update;
  ASSERT_TRUE(Bus::decode(answers_[0].bytes, &update));
  Submap placed;
  ASSERT_EQ(apply_submap_update(update, &placed), "");
  for (const auto& [id, keyframe] : owner.submap.keyframes)
    EXPECT_LT((placed.keyframe(id)->cam_from_submap.center() - owner.placement.cam_from_map(keyframe).center()).norm(),
              1e-12);
  EXPECT_EQ(placed.revision, owner.submap.revision);
  int with_sigmas = 0;
  for (const auto& [utime_us, frame] : placed.frames) {
    EXPECT_EQ(frame.sigmas, (LocatedFrame{&owner, owner.submap.frame(utime_us)}.sigmas())) << utime_us;
    with_sigmas += frame.sigmas.are_known();
  }
  EXPECT_EQ(with_sigmas, 12);

  trajectory_t trajectory;
  EXPECT_EQ(answers_[1].kind, chunk_t::TRAJECTORY);
  ASSERT_TRUE(Bus::decode(answers_[1].bytes, &trajectory));
  const std::map<ImageId, SE3> expected = node_->atlas().map_trajectory();
  EXPECT_EQ(trajectory.map_revision, node_->atlas().revision());
  ASSERT_EQ(trajectory.n, 16);
  for (int i = 0; i < trajectory.n; ++i) {
    EXPECT_EQ(from_wire(trajectory.map_from_cam[i])->translation,
              expected.at({trajectory.frame_utime[i], trajectory.frame_stream[i]}).translation);
    const PoseSigmas& sigmas = placed.frames.at(trajectory.frame_utime[i]).sigmas;
    EXPECT_EQ(trajectory.position_sigma[i], sigmas.position);
    EXPECT_EQ(trajectory.rotation_sigma_rad[i], sigmas.rotation_rad);
    EXPECT_EQ(trajectory.log_scale_sigma[i], sigmas.log_scale);
  }

  map_region_t all, near;
  EXPECT_EQ(answers_[2].kind, chunk_t::REGION);
  ASSERT_TRUE(Bus::decode(answers_[2].bytes, &all));
  ASSERT_TRUE(Bus::decode(answers_[3].bytes, &near));
  EXPECT_EQ(all.nlandmarks, static_cast<int>(owner.submap.landmarks.size()) - 1);  // one is fused
  EXPECT_EQ(all.nkeyframes, static_cast<int>(owner.submap.keyframes.size()));
  EXPECT_EQ(all.map_revision, node_->atlas().revision());
  const auto is_near = [](const Eigen::Vector3d& p) { return (p - Eigen::Vector3d(0.1, 0.2, 0.3)).norm() <= 3; };
  const auto expected_near = std::count_if(all.landmarks.begin(), all.landmarks.end(), [&](const region_landmark_t& l) {
    return is_near(Eigen::Vector3d(l.position));
  });
  EXPECT_EQ(near.nlandmarks, expected_near);
  EXPECT_GT(near.nlandmarks, 0);
  EXPECT_LT(near.nlandmarks, all.nlandmarks);
  for (const region_landmark_t& l : near.landmarks) {
    const Landmark& landmark = *owner.submap.landmark(l.id);
    EXPECT_EQ(Eigen::Vector3d(l.position), owner.placement.position_in_map(owner.submap, landmark));
    EXPECT_EQ(std::memcmp(l.descriptor, landmark.descriptor.data(), sizeof(Descriptor)), 0);
    EXPECT_EQ(l.submap_id, kKey.id);
  }
  for (const region_keyframe_t& k : near.keyframes) EXPECT_TRUE(is_near(from_wire(k.map_from_cam)->translation));
}

TEST_F(MapServerNodeTest, StatusTellsOfLinksAndPlacements) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 4), 0)).ok);
  place({kKey});
  node_->atlas().set_links({{.a = kKey,
                             .b = {7, 1},
                             .kind = Link::Kind::kAppearance,
                             .keyframes = 5,
                             .keyframe_inliers = 4,
                             .landmarks = 90,
                             .landmark_inliers = 80,
                             .rmse_px = 0.5,
                             .doubt = "too good to be true"}});
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

TEST_F(MapServerNodeTest, QuestionsAboutTheMapThatMakeNoSenseAreRefused) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 4), 0)).ok);
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap({7, 2}, 2, 2, 50'000'000), 0)).ok);
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  int id = 0;
  for (const double radius : {nan, inf, 0.0, -1.0}) ask_region(++id, {0, 0, 0}, radius);
  for (const double x : {nan, inf, -inf}) ask_region(++id, {0, x, 0}, 1);
  ask(map_request_t::PLACED_SUBMAP, ++id, {7, 99});
  ask(map_request_t::PLACED_SUBMAP, ++id, {7, 2});
  ASSERT_EQ(answers_.size(), 9);
  for (const auto& answer : answers_) EXPECT_EQ(answer.kind, chunk_t::REFUSED) << answer.request_id;
  const auto text = [this](size_t i) { return std::string(answers_[i].bytes.begin(), answers_[i].bytes.end()); };
  EXPECT_THAT(text(0), HasSubstr("radius nan"));
  EXPECT_THAT(text(7), HasSubstr("no submap 99"));
  EXPECT_THAT(text(8), HasSubstr("not part of the map"));
  ask_region(++id, {1e300, -1e300, 1e300}, 1);  // far from everything
  ASSERT_EQ(answers_.size(), 10);
  map_region_t region;
  ASSERT_TRUE(Bus::decode(answers_[9].bytes, &region));
  EXPECT_EQ(region.nlandmarks + region.nkeyframes, 0);
}

TEST_F(MapServerNodeTest, AnEmptyMapHasAnEmptyTrajectoryAndRegion) {
  ask(map_request_t::TRAJECTORY, 1);
  ask_region(2, {0, 0, 0}, 1);
  ASSERT_EQ(answers_.size(), 2);
  trajectory_t trajectory;
  map_region_t region;
  EXPECT_TRUE(Bus::decode(answers_[0].bytes, &trajectory));
  EXPECT_TRUE(Bus::decode(answers_[1].bytes, &region));
  EXPECT_EQ(trajectory.n + region.nlandmarks + region.nkeyframes, 0);
}

TEST_F(MapServerNodeTest, AFloodOfRequestsIsBounded) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 6), 0)).ok);
  for (int i = 0; i < 1000; ++i) {
    map_request_t request{};
    request.requester = "gone" + std::to_string(i % 500);
    request.request_id = i;
    request.what = map_request_t::SNAPSHOT;
    bus_.publish(channels::kMapRequest, request);
  }
  bus_.dispatch();
  EXPECT_FALSE(node_->finished());
  pass(140);  // nobody takes the answers, five at a time: given up
  EXPECT_TRUE(node_->finished());
  ask(map_request_t::SNAPSHOT, 5);
  EXPECT_EQ(answers_.size(), 1);
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

// Valid messages with a few wrong bytes: whatever gets through the checks must leave a map that can be stored and read.
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
  expect_same(node_->atlas(), node_->store().load());
  EXPECT_TRUE(send_and_wait(make_submap_update(make_submap({7, 77}, 1, 2), 0)).ok);
}

class MapServerNodeOnDisk : public MapServerNodeTest {
 protected:
  MapServerNodeOnDisk()
      : MapServerNodeTest([](MapServerOptions* options) { options->database = folder() / "map.db"; }) {}
  static TemporaryFolder& folder() {
    static TemporaryFolder folder;
    return folder;
  }
  ~MapServerNodeOnDisk() override {
    node_.reset();
    std::filesystem::remove(folder() / "map.db");
  }
};

TEST_F(MapServerNodeOnDisk, FullDiskIsSaidAndNothingIsLost) {
  SubmapMaker maker(kKey, 1);
  maker.step();
  ASSERT_TRUE(send_and_wait(make_submap_update(maker.submap(), 0)).ok);
  EXPECT_FALSE(node_->status().degraded);
  node_->store().limit_bytes(1);
  for (int i = 0; i < 20; ++i) maker.step();
  const TransferResult refused = send_and_wait(make_submap_update(maker.submap(), 1));
  EXPECT_FALSE(refused.ok);
  EXPECT_THAT(refused.reason, HasSubstr("no space left"));
  EXPECT_EQ(refused.revision, 1);
  EXPECT_TRUE(node_->status().degraded);
  EXPECT_THAT(node_->status().detail, HasSubstr("map.db"));
  bus_.publish(channels::kTrack, make_track(900'000, 7, track_t::LOST, kNoSubmap));
  pass(3);
  node_->store().limit_bytes(int64_t{1} << 40);
  const TransferResult retried = send_and_wait(make_submap_update(maker.submap(), refused.revision));
  EXPECT_TRUE(retried.ok) << retried.reason;
  EXPECT_EQ(retried.revision, 21);
  pass(2);
  EXPECT_FALSE(node_->status().degraded);
  expect_same(node_->atlas(), node_->store().load());
}

TEST_F(MapServerNodeOnDisk, ABusyDatabaseIsARefusalThatIsMadeGoodLater) {
  SubmapMaker maker(kKey, 1);
  maker.step();
  Database other(folder() / "map.db");
  other.execute("BEGIN IMMEDIATE");
  const TransferResult refused = send_and_wait(make_submap_update(maker.submap(), 0), 0.2);
  EXPECT_FALSE(refused.ok);
  EXPECT_THAT(refused.reason, HasSubstr("map.db is busy"));
  EXPECT_EQ(refused.revision, 0);
  EXPECT_TRUE(node_->status().degraded);
  EXPECT_THAT(node_->status().detail, HasSubstr("map.db is busy"));
  other.execute("COMMIT");
  EXPECT_TRUE(send_and_wait(make_submap_update(maker.submap(), 0)).ok);
  EXPECT_FALSE(node_->status().degraded);
}

TEST_F(MapServerNodeOnDisk, ADatabaseThatCanNoLongerBeReadEndsNothing) {
  SubmapMaker maker(kKey, 1);
  maker.step();
  ASSERT_TRUE(send_and_wait(make_submap_update(maker.submap(), 0)).ok);
  Database(folder() / "map.db").execute("UPDATE atlas SET map_revision = 77; PRAGMA wal_checkpoint(TRUNCATE)");
  std::fstream(folder() / "map.db", std::ios::in | std::ios::out | std::ios::binary) << std::string(4096, 'x');
  maker.step();
  EXPECT_FALSE(send_and_wait(make_submap_update(maker.submap(), 1)).ok);
  EXPECT_NO_THROW(pass(2));
  EXPECT_TRUE(node_->status().degraded);
  EXPECT_NO_THROW(node_->finish());
}

TEST_F(MapServerNodeOnDisk, ASnapshotIsMadeWhileItGoesOn) {
  SubmapMaker maker(kKey, 1);
  maker.step();
  ASSERT_TRUE(send_and_wait(make_submap_update(maker.submap(), 0)).ok);
  for (const int id : {1, 2, 3}) ask(map_request_t::SNAPSHOT, id);
  // A thread takes its own time, whatever the clock of the bus says.
  for (int i = 0; i < 1000 && answers_.size() < 3; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    pass(0.1);
  }
  ASSERT_EQ(answers_.size(), 3);
  for (const ChunkReceiver::Payload& answer : answers_) {
    EXPECT_EQ(answer.kind, chunk_t::DATABASE);
    testing::write_file(folder() / "answer.db", std::string(answer.bytes.begin(), answer.bytes.end()));
    expect_same(node_->atlas(), MapStore::copy_in_memory(folder() / "answer.db").load());
  }
}

TEST_F(MapServerNodeOnDisk, GoesOnWhereItsPredecessorStopped) {
  SubmapMaker maker(kKey, 1);
  maker.step();
  ASSERT_TRUE(send_and_wait(make_submap_update(maker.submap(), 0)).ok);
  bus_.publish(channels::kTrack, make_track(900'000, 7, track_t::NOT_INITIALIZED, kNoSubmap));
  pass(2);  // frame states are written once a second
  const Atlas before = node_->atlas();
  node_.reset();
  MemoryBus next;
  MapServerNode successor(next, options_);
  expect_same(before, successor.atlas());
  EXPECT_EQ(successor.atlas().frames().at({900'000}).state, TrackingState::kNotInitialized);
}

TEST_F(MapServerNodeOnDisk, FinishWritesWhatIsUnwritten) {
  pass(1.5);
  bus_.publish(channels::kTrack, make_track(900'000, 7, track_t::NOT_INITIALIZED, kNoSubmap));
  bus_.dispatch();
  node_->finish();
  EXPECT_EQ(node_->store().load().frames().size(), 1);
}

struct SnapshotFolder {
  TemporaryFolder folder_;
};

class MapServerNodeSnapshots : public SnapshotFolder, public MapServerNodeTest {
 protected:
  explicit MapServerNodeSnapshots(const std::string& file = "copy.db")
      : MapServerNodeTest([&](MapServerOptions* options) {
          options->snapshot_s = 10;
          options->snapshot_file = folder_ / file;
        }) {}
  bool exists() const { return std::filesystem::exists(options_.snapshot_file); }
};

class MapServerNodeSnapshotsElsewhere : public MapServerNodeSnapshots {
 protected:
  MapServerNodeSnapshotsElsewhere() : MapServerNodeSnapshots("absent/copy.db") {}
};

TEST_F(MapServerNodeSnapshots, AreWrittenOnTimeAndAtTheEnd) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 4), 0)).ok);
  EXPECT_FALSE(exists());
  pass(6);
  ASSERT_TRUE(exists());
  expect_same(node_->atlas(), MapStore(options_.snapshot_file).load());
  std::filesystem::remove(options_.snapshot_file);
  pass(30);
  EXPECT_FALSE(exists());  // there is nothing new
  bus_.publish(channels::kTrack, make_track(900'000, 7, track_t::LOST, kNoSubmap));
  pass(11);
  EXPECT_TRUE(exists());
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 5), 0)).ok);
  node_->finish();
  expect_same(node_->atlas(), MapStore(options_.snapshot_file).load());
  EXPECT_FALSE(node_->status().degraded);
}

TEST_F(MapServerNodeSnapshots, AFullDiskIsSaidAndNothingElseSuffers) {
  const int result = testing::run_on_small_disk(folder_.path().string(), 60'000, [&] {
    SubmapMaker maker(kKey, 1);
    for (int i = 0; i < 30; ++i) maker.step();
    if (!send_and_wait(make_submap_update(maker.submap(), 0)).ok) return 1;
    pass(12);
    const NodeStatus status = node_->status();
    if (!status.degraded || status.detail.find("copy.db") == std::string::npos) return 2;
    if (!std::filesystem::is_empty(folder_.path())) return 3;
    maker.step();
    if (!send_and_wait(make_submap_update(maker.submap(), 30)).ok) return 4;
    return node_->store().stored_revision(kKey) == 31 ? 0 : 5;
  });
  if (result < 0) GTEST_SKIP() << "no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

TEST_F(MapServerNodeSnapshotsElsewhere, TroubleIsOverWhenItIsOver) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 4), 0)).ok);
  pass(11);
  EXPECT_TRUE(node_->status().degraded);
  EXPECT_THAT(node_->status().detail, HasSubstr("absent/copy.db"));
  std::filesystem::create_directory(folder_ / "absent");
  pass(11);
  EXPECT_FALSE(node_->status().degraded);
  EXPECT_TRUE(exists());
}

TEST(MapServerNodeStart, ASnapshotMustNotTakeThePlaceOfTheDatabase) {
  const TemporaryFolder folder;
  MemoryBus bus;
  MapServerOptions options;
  options.database = folder / "map.db";
  options.snapshot_s = 1;
  options.snapshot_file = folder / "./map.db";
  EXPECT_THROW(MapServerNode(bus, options), std::runtime_error);
}

TEST(MapServerNodeStart, AnUnusableDatabaseIsAReasonToEnd) {
  MemoryBus bus;
  MapServerOptions options;
  options.database = "/proc/map.db";
  EXPECT_THROW(MapServerNode(bus, options), std::runtime_error);
}

}  // namespace
}  // namespace rumi::map_server
