// SPDX-License-Identifier: BSD-3-Clause
// map_server and its files: a full disk, a database that is busy or damaged, snapshots.
#include <gmock/gmock.h>

#include <fstream>

#include "tests/map_server/map_server_node_fixture.h"
#include "tests/support/patience.h"

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
  expect_same(node_->atlas(), node_->store().load().value());
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
  // The snapshots are written in a thread, which runs in real time and not by the clock of the bus, so wait for them.
  testing::happens([this] { return answers_.size() == 3; }, [this] { pass(0.1); });
  ASSERT_EQ(answers_.size(), 3);
  for (const ChunkReceiver::Payload& answer : answers_) {
    EXPECT_EQ(answer.kind, chunk_t::DATABASE);
    testing::write_file(folder() / "answer.db", std::string(answer.bytes.begin(), answer.bytes.end()));
    expect_same(node_->atlas(), load_atlas(folder() / "answer.db").value());
  }
}

TEST_F(MapServerNodeOnDisk, GoesOnWhereItsPredecessorStopped) {
  SubmapMaker maker(kKey, 1);
  maker.step();
  ASSERT_TRUE(send_and_wait(make_submap_update(maker.submap(), 0)).ok);
  bus_.publish(channels::kTrack, make_track(900'000, 7, track_t::NOT_INITIALIZED, kNoSubmap));
  pass(2);  // frame states are written every second
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
  EXPECT_EQ(node_->store().load().value().frames().size(), 1);
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
  expect_same(node_->atlas(), MapStore::open(options_.snapshot_file).value().load().value());
  std::filesystem::remove(options_.snapshot_file);
  pass(30);
  EXPECT_FALSE(exists());  // because nothing has changed
  bus_.publish(channels::kTrack, make_track(900'000, 7, track_t::LOST, kNoSubmap));
  pass(11);
  EXPECT_TRUE(exists());
  ASSERT_TRUE(send_and_wait(make_submap_update(make_submap(kKey, 1, 5), 0)).ok);
  node_->finish();
  expect_same(node_->atlas(), MapStore::open(options_.snapshot_file).value().load().value());
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
