// SPDX-License-Identifier: BSD-3-Clause
// The answers of map_server to requests.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "bus/wire/map_overview.h"
#include "bus/wire/pose.h"
#include "lcmtypes/rumi/map_region_t.hpp"
#include "lcmtypes/rumi/trajectory_t.hpp"
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
using testing::TemporaryFolder;

TEST_F(MapServerNodeTest, AMapOfAnySizeIsToldInDatagramsAndWholeWhenAskedFor) {
  for (int id = 1; id <= 1000; ++id)
    EXPECT_TRUE(node_->atlas().change_submap({7, id}, [id](Submap* submap) {
      submap->key = {7, id};
      submap->revision = 1;
      return Result<>();
    }));
  std::vector<Link> links;
  for (int i = 0; i < 5000; ++i) links.push_back({.a = {7, 1}, .b = {7, 2}, .doubt = std::string(100, 'x')});
  EXPECT_TRUE(node_->atlas().set_links(std::move(links)));
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
  ASSERT_EQ(apply_submap_update(update, &copy).error_text(), "");
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
  MapStore store = MapStore::open(folder / "map.db").value();
  const Atlas loaded = store.load().value();
  expect_same(node_->atlas(), loaded);
  EXPECT_EQ(loaded.frames().at({900'000}).state, TrackingState::kLost);
}

TEST_F(MapServerNodeTest, ASnapshotIsNotRefusedBecauseOthersAskALot) {
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 6), 0)).ok);
  map_request_t request{};
  request.requester = "viewer";  // a requester that receives slowly
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
  ask(map_request_t::PLACED_SUBMAP, 1, kKey, 3);  // base_revision has no effect
  ask(map_request_t::TRAJECTORY, 2);
  ask_region(3, {0, 0, 0}, 1e300);
  ask_region(4, {0.1, 0.2, 0.3}, 3);
  ASSERT_EQ(answers_.size(), 4);
  submap_update_t update;
  ASSERT_TRUE(Bus::decode(answers_[0].bytes, &update));
  Submap placed;
  ASSERT_EQ(apply_submap_update(update, &placed).error_text(), "");
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
  EXPECT_EQ(all.nlandmarks, static_cast<int>(owner.submap.landmarks.size()) - 1);  // one landmark is fused into another
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
  pass(140);  // nobody receives the answers; they are given up five at a time
  EXPECT_TRUE(node_->finished());
  ask(map_request_t::SNAPSHOT, 5);
  EXPECT_EQ(answers_.size(), 1);
}

}  // namespace
}  // namespace rumi::map_server
