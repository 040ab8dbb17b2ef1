// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/snapshot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/process/process.h"
#include "bus/transport/memory_bus.h"
#include "map_server/map_server_node.h"
#include "rumi/outputs/map_file.h"
#include "tests/rumi/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

using ::testing::HasSubstr;

// Behaves like a live bus: dispatch() takes time, in which the other processes work.
class LivingBus : public MemoryBus {
 public:
  LivingBus() { set_now_us(1'000'000); }
  int dispatch(int timeout_ms) override {
    set_now_us(now_us() + timeout_ms * 1000);
    if (others) others(now_us());
    return MemoryBus::dispatch();
  }
  std::function<void(int64_t now_us)> others;
};

class SnapshotTest : public ::testing::Test {
 protected:
  SnapshotTest() {
    options_.database = folder_ / "map.db";
    options_.merge.thread = false;  // a thread would not keep to the clock of the bus
    EXPECT_TRUE(map_server::MapStore::open(options_.database).value().save(make_test_atlas(), {ImageId{1'400'000}}));
  }
  void serve() {
    server_ = std::make_unique<map_server::MapServerNode>(bus_, options_);
    status_ = std::make_unique<StatusPublisher>(bus_, "map_server");
    bus_.others = [this](int64_t now_us) {
      server_->tick(now_us);
      status_->tick(*server_, now_us);
    };
  }
  const testing::TemporaryFolder folder_;
  LivingBus bus_;
  map_server::MapServerOptions options_;
  std::unique_ptr<map_server::MapServerNode> server_;
  std::unique_ptr<StatusPublisher> status_;
};

TEST_F(SnapshotTest, BringsTheDatabaseAndTheStatusOfTheProcesses) {
  serve();
  const Result<Snapshot> result = request_snapshot(bus_, 10, 1.5);
  ASSERT_EQ(result.error_text(), "");
  ASSERT_TRUE(result->processes.count("map_server"));
  const std::string copy = options_.database + ".copy";
  std::string copy_problem;
  const map_server::Atlas atlas = load_map_bytes(result->database, copy, &copy_problem);
  EXPECT_EQ(copy_problem, "");
  EXPECT_EQ(atlas.frames_in_map(), 4);
  EXPECT_EQ(load_map(copy).frames_in_map(), 4);
}

TEST_F(SnapshotTest, SurvivesALossyBus) {
  serve();
  int messages = 0;
  bus_.set_tap([&](const std::string&, std::span<const uint8_t>) { return ++messages % 3 != 0; });
  const Result<Snapshot> result = request_snapshot(bus_, 10, 0);
  ASSERT_EQ(result.error_text(), "");
  std::string copy_problem;
  EXPECT_EQ(load_map_bytes(result->database, options_.database + ".copy", &copy_problem).frames_in_map(), 4);
  EXPECT_EQ(copy_problem, "");
}

TEST_F(SnapshotTest, AMapThatCannotBeCopiedIsStillThere) {
  serve();
  const Result<Snapshot> result = request_snapshot(bus_, 10, 0);
  std::string copy_problem;
  EXPECT_EQ(load_map_bytes(result->database, "/nowhere/map.db", &copy_problem).frames_in_map(), 4);
  EXPECT_THAT(copy_problem, HasSubstr("/nowhere/map.db"));
}

TEST_F(SnapshotTest, SaysThatNobodyAnswers) {
  const int64_t begin_us = bus_.now_us();
  EXPECT_THAT(request_snapshot(bus_, 3, 0).error_text(), HasSubstr("no map_server answered within 3 s"));
  EXPECT_NEAR(static_cast<double>(bus_.now_us() - begin_us) * 1e-6, 3.0, 0.1);
}

TEST_F(SnapshotTest, SaysThatTheServerWentAwayInTheMiddle) {
  serve();
  int chunks = 0;
  bus_.set_tap([&](const std::string& channel, std::span<const uint8_t>) {
    return channel != channels::kMapChunk || ++chunks <= 1;  // the first piece arrives, and no other
  });
  const Result<Snapshot> result = request_snapshot(bus_, 3, 0);
  EXPECT_THAT(result.error_text(), HasSubstr("stopped coming after 1 of"));
}

}  // namespace
}  // namespace rumi::tool
