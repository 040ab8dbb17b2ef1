// SPDX-License-Identifier: BSD-3-Clause
// map_server receives submaps, and makes one map of all connected ones, in whatever order they come.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <thread>

#include "tests/map_server/merging_node_fixture.h"

namespace rumi::testing {
namespace {

using ::testing::HasSubstr;

TEST_F(MergingNodeTest, OneMapInAnyOrderOfArrival) {
  const std::vector<std::vector<SubmapKey>> orders = {kAll,
                                                      {kBack2, kBack1, kFront3, kFront2, kFront1},
                                                      {kFront3, kFront1, kFront2, kBack2, kBack1},
                                                      {kFront2, kFront2, kBack1, kFront1, kBack1, kFront3, kBack2}};
  double worst_m = 0;
  for (const std::vector<SubmapKey>& order : orders) {
    start();
    int64_t revision = 0;
    for (const SubmapKey key : order) {
      ASSERT_TRUE(send(key).ok);
      pass(2.5);
      EXPECT_GE(side_->status.map_revision, revision);
      revision = side_->status.map_revision;
    }
    EXPECT_GT(side_->status.frames_in_map, 46) << "of the largest front submap";
    settle();
    EXPECT_GT(side_->status.map_revision, revision);
    EXPECT_FALSE(side_->status.merging);
    expect_one_map();
    worst_m = std::max(worst_m, chain_->error(node_->atlas()).rmse);
  }
  std::printf("any order: ATE %.1f mm at most\n", 1000 * worst_m);
}

TEST_F(MergingNodeTest, AllAtOnce) {
  options_.merge.interval_s = 100;
  start();
  send_all();
  EXPECT_EQ(side_->status.nlinks, 0);
  pass(101);
  settle();
  expect_one_map();
}

TEST_F(MergingNodeTest, ThePartsOfASubmapMayComeLate) {
  start();
  std::map<SubmapKey, Growth> growing;
  for (const SubmapKey key : kAll) {
    growing[key] = grow(chain_->submap(key), 6);
    ASSERT_TRUE(send(make_submap_update(growing[key].early, 0)).ok);
  }
  pass(3);
  EXPECT_LT(side_->status.frames_in_map, Chain::kImages);
  for (const SubmapKey key : {kBack2, kFront1, kFront3, kBack1, kFront2}) {
    ASSERT_TRUE(send(make_submap_update(growing[key].late, 1)).ok);
    ASSERT_TRUE(send(make_submap_update(growing[key].early, 0)).ok) << "old news";
    pass(3);
  }
  settle();
  expect_one_map();
}

// The map does not jump or change its unit for those who use it.
TEST_F(MergingNodeTest, TheAnchorKeepsItsGauge) {
  start();
  ASSERT_TRUE(send(kFront2).ok);
  pass(3);
  const Keyframe first = chain_->submap(kFront2).keyframes.begin()->second;
  const auto expect_gauge = [&](SubmapKey anchor, const SE3& cam_from_map, double scale) {
    const AtlasSubmap& owner = *node_->atlas().find(anchor);
    const Keyframe& keyframe = owner.submap.keyframes.begin()->second;
    ASSERT_TRUE(owner.in_map);
    EXPECT_LT((owner.placement.cam_from_map(keyframe).center() - cam_from_map.center()).norm(), 1e-6 * scale);
    EXPECT_LT(rotation_error_deg(owner.placement.cam_from_map(keyframe), cam_from_map), 1e-4);
    EXPECT_NEAR(owner.placement.at(keyframe.utime_us).scale, scale, 1e-9 * scale);
  };
  for (const SubmapKey key : {kBack2, kFront3}) {
    ASSERT_TRUE(send(key).ok);
    pass(3);
    expect_gauge(kFront2, first.cam_from_submap, 1);
  }
  settle();
  expect_gauge(kFront2, first.cam_from_submap, 1);
  // An older submap that joins later becomes the anchor.
  ASSERT_TRUE(send(kFront1).ok);
  ASSERT_TRUE(send(kBack1).ok);
  pass(3);
  const AtlasSubmap& oldest = *node_->atlas().find(kFront1);
  ASSERT_TRUE(oldest.in_map);
  expect_gauge(kFront2, first.cam_from_submap, 1);
  const Keyframe& keyframe = oldest.submap.keyframes.begin()->second;
  const SE3 then = oldest.placement.cam_from_map(keyframe);
  const double scale = oldest.placement.at(keyframe.utime_us).scale;
  settle();
  expect_gauge(kFront1, then, scale);
}

TEST_F(MergingNodeTest, ASnapshotWaitsForTheMap) {
  for (const bool thread : {false, true}) {
    options_.merge.thread = thread;
    options_.merge.interval_s = 100;
    start();
    send_all();
    EXPECT_EQ(node_->atlas().frames_in_map(), 46);
    ask_for(map_request_t::SNAPSHOT);
    if (thread) {
      EXPECT_TRUE(side_->answers.empty());
      ask_for(map_request_t::STATUS);
      EXPECT_TRUE(side_->status.merging);
    }
    wait();
    pass(5);
    ASSERT_EQ(side_->answers.size(), 1u);
    ASSERT_EQ(side_->answers[0].kind, chunk_t::DATABASE);
    const TemporaryFolder folder;
    write_file(folder / "map.db", std::string(side_->answers[0].bytes.begin(), side_->answers[0].bytes.end()));
    const Atlas snapshot = MapStore::open(folder / "map.db").value().load().value();
    expect_same(node_->atlas(), snapshot);
    EXPECT_EQ(snapshot.frames_in_map(), Chain::kImages);
    for (const auto& [key, owner] : snapshot.submaps()) {
      EXPECT_TRUE(owner.in_map);
      EXPECT_EQ(owner.placement.map_from_submap.size(), owner.submap.keyframes.size());
    }
    EXPECT_EQ(std::count_if(snapshot.links().begin(), snapshot.links().end(),
                            [](const Link& l) { return l.accepted() && l.kind == Link::Kind::kSameImages; }),
              4);
    expect_one_map();
  }
}

// A snapshot contains everything that came before its request, even what came after the running adjustment began.
TEST_F(MergingNodeTest, ASnapshotDoesNotGoWithoutWhatCameDuringAnAdjustment) {
  options_.merge.thread = true;
  options_.merge.interval_s = 100;
  start();
  for (const SubmapKey key : {kFront1, kBack1, kFront2}) ASSERT_TRUE(send(key).ok);
  wait();
  ask_for(map_request_t::SNAPSHOT, 1);
  for (const SubmapKey key : {kBack2, kFront3}) ASSERT_TRUE(send(key).ok);
  ask_for(map_request_t::SNAPSHOT, 2);
  wait();
  pass(5);
  ASSERT_EQ(side_->answers.size(), 2u);
  EXPECT_EQ(side_->answers[1].request_id, 2);
  const TemporaryFolder folder;
  write_file(folder / "map.db", std::string(side_->answers[1].bytes.begin(), side_->answers[1].bytes.end()));
  EXPECT_EQ(MapStore::open(folder / "map.db").value().load().value().frames_in_map(), Chain::kImages);
}

TEST_F(MergingNodeTest, WhatIsLeftIsMergedAtTheEnd) {
  options_.merge.interval_s = 100;
  start();
  send_all();
  node_->finish();
  for (int i = 0; i < 100 && !node_->finished(); ++i) step();
  EXPECT_TRUE(node_->finished());
  side_->bus.dispatch();
  expect_one_map();
}

TEST_F(MergingNodeTest, ARestartedOneGoesOnWithTheMap) {
  const TemporaryFolder folder;
  options_.database = folder / "map.db";
  start();
  for (const SubmapKey key : {kFront1, kBack1, kFront2, kFront3}) ASSERT_TRUE(send(key).ok);
  settle();
  EXPECT_FALSE(in_map(kFront3));
  const Atlas before = node_->atlas();
  start();
  expect_same(before, node_->atlas());
  step();
  pass(1);
  for (const SubmapKey key : {kFront1, kBack1, kFront2}) EXPECT_TRUE(in_map(key));
  ASSERT_TRUE(send(kBack2).ok);
  settle();
  expect_one_map();
  const AtlasSubmap &was = *before.find(kFront1), &is = *node_->atlas().find(kFront1);
  const Keyframe& first = was.submap.keyframes.begin()->second;
  EXPECT_LT((was.placement.cam_from_map(first).center() - is.placement.cam_from_map(first).center()).norm(), 1e-6);
  stop();
}

// Formerly, such a database ended map_server at each start.
TEST_F(MergingNodeTest, ServesTheMapOfADatabaseThatNoBuildCanUse) {
  const TemporaryFolder folder;
  options_.database = folder / "map.db";
  start();
  send_all();
  settle();
  const int64_t revision = side_->status.map_revision;
  start();
  EXPECT_TRUE(node_->atlas().change_submap(kBack2, [](Submap* submap) {  // map.db is checked when it is read
    ++submap->revision;
    break_submap(submap);
    return Result<>();
  }));
  for (int i = 0; i < 2; ++i) {
    pass(60);
    for (const SubmapKey key : kAll) EXPECT_TRUE(in_map(key)) << key.id;
    EXPECT_GE(side_->status.map_revision, revision);
    const NodeStatus status = node_->status();
    EXPECT_TRUE(status.degraded);
    EXPECT_THAT(status.detail, HasSubstr("a build of the map broke off ("));
    EXPECT_THAT(status.detail, HasSubstr("left out until changed: submap -2"));
  }
  // The map continues to grow without the broken submap.
  SubmapKey other{Chain::kSession, 9};
  Submap copy = chain_->submap(kFront3);
  copy.key = other;
  ASSERT_TRUE(send(make_submap_update(copy, 0)).ok);
  settle();
  EXPECT_TRUE(in_map(other));
  EXPECT_TRUE(in_map(kBack2));
  stop();
}

TEST_F(MergingNodeTest, KilledWhileItMergesItMakesTheSameMap) {
  const TemporaryFolder folder;
  options_.database = folder / "map.db";
  const pid_t child = fork();
  if (child == 0) {
    options_.merge.thread = true;
    start();
    for (const SubmapKey key : kAll)
      if (!send(key).ok) _exit(1);
    wait();
    ask_for(map_request_t::SNAPSHOT);
    ask_for(map_request_t::STATUS);
    if (side_->status.merging) raise(SIGKILL);
    _exit(2);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << WEXITSTATUS(status);
  start();
  EXPECT_EQ(node_->atlas().submaps().size(), kAll.size()) << "what was acknowledged";
  settle();
  expect_one_map();
  stop();
}

TEST_F(MergingNodeTest, ABackSubmapIsServedWithoutAFrontOne) {
  start();
  ASSERT_TRUE(send(kBack1).ok);
  pass(1.5);  // until the next status
  EXPECT_TRUE(in_map(kBack1)) << "before it is adjusted";
  settle();
  EXPECT_TRUE(in_map(kBack1));
  EXPECT_EQ(node_->atlas().frames_in_map(), static_cast<int64_t>(chain_->submap(kBack1).frames.size()));
  ASSERT_TRUE(send(kFront1).ok);
  settle();
  EXPECT_TRUE(in_map(kFront1));
  EXPECT_TRUE(in_map(kBack1));
}

TEST_F(MergingNodeTest, WhatIsCulledStaysAwayAndItsBytesAreGivenBack) {
  const TemporaryFolder folder;
  int64_t bytes[2] = {};
  for (const bool cull : {false, true}) {
    options_.database = folder / (cull ? "culled.db" : "all.db");
    options_.merge.builder.culling.enabled = cull;
    start();
    send_all();
    settle();
    expect_one_map();
    bytes[cull] = node_->store().bytes();
  }
  std::printf("%lld bytes with post-culling, %lld without\n", static_cast<long long>(bytes[1]),
              static_cast<long long>(bytes[0]));
  EXPECT_LT(bytes[1], 0.95 * static_cast<double>(bytes[0]));
  const size_t left = node_->atlas().find(kBack1)->submap.keyframes.size();
  EXPECT_LT(left, chain_->submap(kBack1).keyframes.size());
  // The sender did not receive the acknowledgement, and sends again.
  const TransferResult again = send(kBack1);
  EXPECT_TRUE(again.ok);
  EXPECT_GE(again.revision, chain_->submap(kBack1).revision);
  EXPECT_EQ(node_->atlas().find(kBack1)->submap.keyframes.size(), left);
  const int64_t revision = node_->atlas().revision();
  settle();
  EXPECT_EQ(node_->atlas().revision(), revision) << "what is culled is no news";
  start();
  EXPECT_EQ(node_->atlas().find(kBack1)->submap.keyframes.size(), left);
  settle();
  expect_one_map();
  stop();
}

TEST_F(MergingNodeTest, ASubmapThatIsRefusedHoldsNothingUp) {
  start();
  Submap bad = chain_->submap(kBack1);
  bad.key.id = -9;
  bad.landmarks.begin()->second.position.y() = std::nan("");
  EXPECT_THAT(send(make_submap_update(bad, 0)).reason, HasSubstr("not finite"));
  bad = chain_->submap(kBack1);
  bad.keyframes.begin()->second.cam_from_submap.translation.x() = INFINITY;
  EXPECT_FALSE(send(make_submap_update(bad, 0)).ok);
  send_all();
  settle();
  expect_one_map();
}

TEST_F(MergingNodeTest, ARefusedLinkIsToldWithItsReason) {
  start();
  ASSERT_TRUE(send(make_submap_update(chain_->spoiled(kBack1), 0)).ok);
  for (const SubmapKey key : {kFront1, kFront2, kBack2, kFront3}) ASSERT_TRUE(send(key).ok);
  settle();
  int refused = 0;
  for (const link_t& l : side_->status.links) {
    if (l.kind != link_t::SAME_IMAGES || (l.submap_a != kBack1.id && l.submap_b != kBack1.id)) continue;
    EXPECT_FALSE(l.accepted);
    EXPECT_NE(l.doubt, "");
    ++refused;
  }
  EXPECT_EQ(refused, 2);
  EXPECT_EQ(accepted_links(), 2);
  for (const SubmapKey key : {kFront2, kBack2, kFront3}) EXPECT_TRUE(in_map(key));
  EXPECT_FALSE(in_map(kBack1));
  EXPECT_FALSE(in_map(kFront1));
  EXPECT_EQ(side_->status.frames_in_map, Chain::kImages - 54);
  expect_same(node_->atlas(), node_->store().load().value());
}

TEST_F(MergingNodeTest, AFullDiskIsSaidAndTheMapIsStoredLater) {
  const TemporaryFolder folder;
  options_.database = folder / "map.db";
  options_.merge.interval_s = 10;
  options_.merge.builder.culling.enabled = false;  // culling would make room
  start();
  send_all();
  ASSERT_FALSE(node_->status().degraded);
  node_->store().limit_bytes(1);
  pass(11);
  EXPECT_TRUE(node_->status().degraded);
  EXPECT_THAT(node_->status().detail, HasSubstr("no space left"));
  EXPECT_EQ(side_->status.frames_in_map, Chain::kImages) << "it is served all the same";
  EXPECT_LT(node_->store().load().value().frames_in_map(), Chain::kImages);
  ask_for(map_request_t::SNAPSHOT);
  pass(5);
  ASSERT_EQ(side_->answers.size(), 1u);
  EXPECT_EQ(side_->answers[0].kind, chunk_t::REFUSED);

  node_->store().limit_bytes(int64_t{1} << 40);
  pass(2);
  EXPECT_FALSE(node_->status().degraded);
  expect_one_map();
  settle();
  expect_one_map();
  stop();
}

TEST_F(MergingNodeTest, WithoutMergingTheMapIsTheLargestFrontSubmap) {
  options_.merge.enabled = false;
  start();
  send_all();
  settle();
  EXPECT_EQ(side_->status.frames_in_map, 46);
  EXPECT_EQ(side_->status.nlinks, 0);
  EXPECT_TRUE(in_map(kFront2));
}

}  // namespace
}  // namespace rumi::testing
