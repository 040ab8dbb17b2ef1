// SPDX-License-Identifier: BSD-3-Clause
// map_server with a map of an earlier session: with localize_only, where new submaps are placed in the unchanged map,
// and without, where the map goes on.
#include <gmock/gmock.h>

#include <cstdio>

#include "bus/transport/memory_bus.h"
#include "bus/wire/submap_update.h"
#include "map_server/map_server_node.h"
#include "tests/map_server/places/place_scene.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

using ::testing::HasSubstr;

// Two submaps of session 7 are the map, the third is apart from it; session 8 comes later.
constexpr SubmapKey kFirst{7, 1}, kSecond{7, 2}, kApart{7, 3}, kLater{8, 1}, kElsewhere{8, 2};

class LocalizeOnlyTest : public ::testing::Test {
 protected:
  LocalizeOnlyTest() : scene_(3), points_(scene_.cloud(700)) {
    map_from_world_ = scene_.gauge(1.7);
    database_ = folder_ / "map.db";
    options_.database = database_;
    options_.merge.thread = false;
    start();
    EXPECT_TRUE(send(film(kFirst, points_, scene_.path(0, 0, 0), map_from_world_)).ok);
    EXPECT_TRUE(send(film(kSecond, points_, scene_.path(0.3, -0.1, 0.1, 0.05), scene_.gauge(2))).ok);
    EXPECT_TRUE(send(film(kApart, scene_.cloud(300), scene_.path(0, 0, 0), scene_.gauge(1))).ok);
    end();
    node_.reset();
    bytes_ = read_file(database_);
    options_.localize_only = true;
  }

  // Makes a submap whose frames are all keyframes. Different submaps have different times.
  Submap film(SubmapKey key, const std::vector<ScenePoint>& points, const std::vector<SE3>& cams_from_world,
              const Sim3& submap_from_world) {
    Submap submap = scene_.submap(key, points, cams_from_world, submap_from_world);
    for (auto& [id, keyframe] : submap.keyframes) {
      keyframe.revision = keyframe.created_revision = 1;
      keyframe.utime_us += first_utime_us(key);
      submap.frames.set({keyframe.utime_us, id, {}, 1});
    }
    for (auto& [id, landmark] : submap.landmarks) landmark.revision = 1;
    return submap;
  }
  static int64_t first_utime_us(SubmapKey key) { return 1'000'000'000 * key.session + 100'000'000 * key.id; }
  void start() {
    bus_ = std::make_unique<MemoryBus>();
    bus_->set_now_us(now_us_);
    maker_ = std::make_unique<ChunkSender>(*bus_, channels::kSubmap, channels::kSubmapAck, "front_tracker@test:1");
    node_ = std::make_unique<MapServerNode>(*bus_, options_);
  }
  void pass(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 20); ++i) {
      bus_->set_now_us(now_us_ += 50'000);
      bus_->dispatch();
      node_->tick(now_us_);
      maker_->tick(now_us_);
      bus_->dispatch();
    }
  }
  TransferResult send(const Submap& submap) {
    TransferResult result{.ok = false, .reason = "no answer"};
    maker_->send("", chunk_t::SUBMAP_UPDATE, 0, encode_message(make_submap_update(submap, 0)),
                 [&](const TransferResult& r) { result = r; });
    pass(3);
    return result;
  }
  // Makes another database, with one front submap that was never placed.
  void make_single_map() {
    options_.database = database_ = folder_ / "single.db";
    options_.merge.enabled = false;
    start();
    EXPECT_TRUE(send(film(kFirst, points_, scene_.path(0, 0, 0), map_from_world_)).ok);
    end();
    node_.reset();
  }
  void end() {
    node_->finish();
    pass(5);
  }
  void expect_map_untouched(const Atlas& before) {
    for (const auto& [key, owner] : before.submaps()) {
      const AtlasSubmap* now = node_->atlas().find(key);
      ASSERT_TRUE(now);
      EXPECT_EQ(now->in_map, owner.in_map);
      expect_same(now->submap, owner.submap);
      expect_same(now->placement, owner.placement);
    }
    EXPECT_EQ(read_file(database_), bytes_);
  }

  PlaceScene scene_;
  std::vector<ScenePoint> points_;
  Sim3 map_from_world_;  // the map's frame of reference is the one of its first submap
  TemporaryFolder folder_;
  std::string database_, bytes_;
  MapServerOptions options_;
  int64_t now_us_ = 1'000'000;
  std::unique_ptr<MemoryBus> bus_;
  std::unique_ptr<ChunkSender> maker_;
  std::unique_ptr<MapServerNode> node_;
};

TEST_F(LocalizeOnlyTest, WhatIsNewIsPlacedInAMapThatStaysAsItIs) {
  const Atlas before = load_atlas(database_).value();
  ASSERT_TRUE(before.find(kFirst)->in_map && before.find(kSecond)->in_map);
  ASSERT_FALSE(before.find(kApart)->in_map);
  start();
  const std::vector<SE3> path = scene_.path(0.5, 0.1, 0.2, -0.1);
  ASSERT_TRUE(send(film(kLater, points_, path, scene_.gauge(0.7))).ok);
  const AtlasSubmap& placed = *node_->atlas().find(kLater);
  EXPECT_TRUE(placed.in_map) << "at once";
  expect_map_untouched(before);
  end();
  ASSERT_TRUE(placed.in_map);
  EXPECT_TRUE(node_->complaints().empty());
  expect_map_untouched(before);
  EXPECT_GT(node_->atlas().links().size(), before.links().size());
  for (const Link& link : before.links())
    EXPECT_TRUE(std::count(node_->atlas().links().begin(), node_->atlas().links().end(), link));

  const auto trajectory = node_->atlas().map_trajectory();
  double worst = 0, worst_deg = 0;
  for (size_t i = 0; i < path.size(); ++i) {
    const SE3& estimate = trajectory.at({first_utime_us(kLater) + 1'000'000 * static_cast<int64_t>(i + 1)});
    const SE3 truth = map_from_world_.transform_camera(path[i]).inverse();
    worst = std::max(worst, (estimate.translation - truth.translation).norm() / map_from_world_.scale);
    worst_deg = std::max(worst_deg, estimate.rotation.angularDistance(truth.rotation) * 180 / M_PI);
  }
  std::printf("a camera 2 to 8 away from all it sees is placed within %.4f and %.3f deg\n", worst, worst_deg);
  EXPECT_LT(worst, 0.02);
  EXPECT_LT(worst_deg, 0.3);
  // Landmarks that the map has already are fused into the map's.
  int into_the_map = 0;
  for (const auto& [id, into] : placed.placement.fused) into_the_map += into.submap != kLater;
  EXPECT_GT(into_the_map, 100);
}

TEST_F(LocalizeOnlyTest, WhatFitsNowhereDoesNotTakeTheMapsPlace) {
  const Atlas before = load_atlas(database_).value();
  start();
  std::vector<SE3> long_path;
  for (int i = 0; i < 5; ++i)
    for (const SE3& pose : scene_.path(0.1 * i, 0, 0)) long_path.push_back(pose);
  const Submap elsewhere = film(kElsewhere, scene_.cloud(500), long_path, scene_.gauge(1));
  ASSERT_GT(static_cast<int64_t>(elsewhere.frames.size()), before.frames_in_map());
  ASSERT_TRUE(send(elsewhere).ok);
  end();
  EXPECT_FALSE(node_->atlas().find(kElsewhere)->in_map);
  EXPECT_THAT(node_->complaints(), ::testing::ElementsAre(::testing::HasSubstr("not localized: nothing that came")));
  EXPECT_EQ(node_->atlas().frames_in_map(), before.frames_in_map());
  expect_map_untouched(before);
}

// The map is a single front submap that was never placed.
TEST_F(LocalizeOnlyTest, AMapOfASingleSubmapIsAMap) {
  options_.localize_only = false;
  make_single_map();
  bytes_ = read_file(database_);
  const Atlas before = load_atlas(database_).value();
  ASSERT_EQ(before.find(kFirst)->placement.revision, 0);
  options_.localize_only = true;
  options_.merge.enabled = true;
  start();
  ASSERT_TRUE(send(film(kLater, points_, scene_.path(0.4, 0, 0.1), scene_.gauge(0.7))).ok);
  end();
  EXPECT_TRUE(node_->atlas().find(kLater)->in_map);
  EXPECT_TRUE(node_->atlas().find(kFirst)->in_map);
  EXPECT_TRUE(same_place(node_->atlas().find(kFirst)->placement, Placement()));
  expect_same(node_->atlas().find(kFirst)->submap, before.find(kFirst)->submap);
  EXPECT_EQ(read_file(database_), bytes_);
}

TEST_F(LocalizeOnlyTest, AnUpdateOfTheMapIsRefused) {
  const Atlas before = load_atlas(database_).value();
  start();
  Submap more = before.find(kSecond)->submap;
  ++more.revision;
  const TransferResult result = send(more);
  EXPECT_FALSE(result.ok);
  EXPECT_THAT(result.reason, HasSubstr("localize_only"));
  expect_map_untouched(before);
}

TEST_F(LocalizeOnlyTest, ThereMustBeAMap) {
  for (const std::string& name : {std::string(":memory:"), folder_ / "absent.db", folder_ / "empty.db"}) {
    if (name == folder_ / "empty.db") MapStore empty = MapStore::open(name).value();
    options_.database = name;
    try {
      start();
      ADD_FAILURE() << name;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
    }
  }
}

// Tests of a new session without localize_only.
class NextSessionTest : public LocalizeOnlyTest {
 protected:
  NextSessionTest() {
    options_.localize_only = false;
    before_ = load_atlas(database_).value();
  }
  bool in_map(SubmapKey key) const { return node_->atlas().find(key)->in_map; }
  // Expects the map of the earlier session where it was; an adjustment may have moved it a little.
  void expect_it_lies_where_it_lay() const {
    for (const SubmapKey key : {kFirst, kSecond}) {
      const AtlasSubmap &was = *before_.find(key), &is = *node_->atlas().find(key);
      for (const auto& [id, keyframe] : was.submap.keyframes) {
        const SE3 a = was.placement.cam_from_map(keyframe).inverse(), b = is.placement.cam_from_map(keyframe).inverse();
        EXPECT_LT((a.translation - b.translation).norm(), 0.02 * map_from_world_.scale) << key.id << " " << id;
      }
    }
  }
  map_status_t status() {
    map_status_t last{};
    bus_->subscribe<map_status_t>(channels::kMapStatus, {}, [&](const map_status_t& status) { last = status; });
    pass(2);
    return last;
  }
  // Publishes the state of an image of front_tracker without a pose.
  void pass_to_image_at(int64_t utime_us) {
    bus_->publish(channels::kTrack, testing::make_track(utime_us, kElsewhere.session, track_t::LOST, kNoSubmap));
    pass(0.1);
  }
  Atlas before_;
};

TEST_F(NextSessionTest, IsAMapOfItsOwnUntilItIsJoinedToTheOneBefore) {
  start();
  EXPECT_TRUE(in_map(kFirst)) << "until there is anything else";
  pass_to_image_at(20'000'000);
  ASSERT_TRUE(send(film(kElsewhere, scene_.cloud(500), scene_.path(0, 0, 0), scene_.gauge(1))).ok);
  EXPECT_TRUE(in_map(kElsewhere));
  EXPECT_FALSE(in_map(kFirst));
  EXPECT_FALSE(in_map(kSecond));
  expect_it_lies_where_it_lay();
  const map_status_t apart = status();
  EXPECT_EQ(apart.earlier_frames, static_cast<int64_t>(before_.frames().size()));
  EXPECT_EQ(apart.localized_frames, 0);
  EXPECT_EQ(apart.localized_after_s, -1);

  // Later the same session sees the place of the map.
  pass_to_image_at(22'500'000);
  ASSERT_TRUE(send(film(kLater, points_, scene_.path(0.5, 0.1, 0.2, -0.1), scene_.gauge(0.7))).ok);
  end();
  EXPECT_TRUE(in_map(kFirst) && in_map(kSecond) && in_map(kLater));
  EXPECT_FALSE(in_map(kElsewhere));
  expect_it_lies_where_it_lay();
  const map_status_t joined = status();
  EXPECT_EQ(joined.localized_frames, static_cast<int64_t>(node_->atlas().find(kLater)->submap.frames.size()));
  EXPECT_EQ(joined.localized_after_s, 2.5);
}

TEST_F(NextSessionTest, LeavesTheMapBeforeWhereItLayForTheOneAfter) {
  start();
  ASSERT_TRUE(send(film(kElsewhere, scene_.cloud(500), scene_.path(0, 0, 0), scene_.gauge(1))).ok);
  end();
  ASSERT_TRUE(in_map(kElsewhere) && !in_map(kFirst));
  node_.reset();
  options_.localize_only = true;
  start();
  EXPECT_TRUE(in_map(kFirst) && !in_map(kElsewhere)) << "the larger one is looked at";
  ASSERT_TRUE(send(film({8, 3}, points_, scene_.path(0.4, 0, 0.1), scene_.gauge(0.7))).ok);
  EXPECT_TRUE(in_map({8, 3}));
  node_.reset();
  options_.localize_only = false;
  start();
  expect_it_lies_where_it_lay();
  ASSERT_TRUE(send(film({9, 1}, points_, scene_.path(0.5, 0.1, 0.2, -0.1), scene_.gauge(0.7))).ok);
  end();
  EXPECT_TRUE(in_map(kFirst) && in_map(kSecond) && in_map({9, 1}));
  expect_it_lies_where_it_lay();
}

// The single submap was never placed, because there was no other.
TEST_F(NextSessionTest, JoinsAMapOfASingleSubmapInItsFrameOfReference) {
  make_single_map();
  options_.merge.enabled = true;
  start();
  ASSERT_TRUE(send(film(kLater, points_, scene_.path(0.4, 0, 0.1), scene_.gauge(0.7))).ok);
  end();
  ASSERT_TRUE(in_map(kFirst) && in_map(kLater));
  const AtlasSubmap& first = *node_->atlas().find(kFirst);
  const Keyframe& keyframe = first.submap.keyframes.begin()->second;
  EXPECT_LT(
      (first.placement.cam_from_map(keyframe).inverse().translation - keyframe.cam_from_submap.inverse().translation)
          .norm(),
      0.02 * map_from_world_.scale);
}

}  // namespace
}  // namespace rumi::testing
