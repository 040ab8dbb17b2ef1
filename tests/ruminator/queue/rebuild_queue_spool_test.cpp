// SPDX-License-Identifier: BSD-3-Clause
// The queue and its spool: shared, damaged, full, or left by a process that was killed.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>

#include <fstream>
#include <limits>

#include "bus/wire/submap_update.h"
#include "tests/ruminator/queue/queue_world.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using testing::fake_builder;
using testing::fake_result;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::RebuildQueueTest;
using testing::small_job;
using testing::World;

TEST_F(RebuildQueueTest, TwoRuminatorsShareTheWork) {
  options_.build_thread = true;
  std::atomic<int> built_by_a = 0, built_by_b = 0;
  std::atomic<bool> go = false;
  const auto builder = [&go](std::atomic<int>* built) {
    return [built, &go](const WindowJob& job, const std::string&, const auto&, const auto&) {
      ++*built;
      while (!go) usleep(1000);
      return fake_result(job);
    };
  };
  World a(options_, builder(&built_by_a));
  for (int id = 1; id <= 4; ++id) a.queue->add(small_job(id));
  World b(options_, builder(&built_by_b));
  ASSERT_TRUE(a.run_until([&] { return built_by_a == 1; }));
  ASSERT_TRUE(b.run_until([&] { return built_by_b == 1; }));
  go = true;
  ASSERT_TRUE(a.run_until([&] {
    b.tick();
    return a.received.size() + b.received.size() == 4;
  }));
  a.run_for(1), b.run_for(1);
  std::vector<int32_t> all = a.received;
  all.insert(all.end(), b.received.begin(), b.received.end());
  EXPECT_THAT(all, ::testing::UnorderedElementsAre(-1, -2, -3, -4));
  EXPECT_EQ(built_by_a + built_by_b, 4);
  EXPECT_THAT(left(), IsEmpty());
}

TEST_F(RebuildQueueTest, ASpoolThatCannotBeUsedIsSaidAndLivedWithout) {
  testing::write_file(folder_ / "spool", "a file");
  World world(options_, fake_builder());
  EXPECT_TRUE(world.queue->degraded());
  EXPECT_THAT(world.queue->detail(), HasSubstr("--set ruminator.spool=FOLDER"));
  world.queue->add(small_job(1));
  world.run_for(1);
  EXPECT_THAT(world.received, ElementsAre(-1));
}

TEST_F(RebuildQueueTest, DamagedFilesInTheSpoolAreFailuresOnce) {
  {
    const auto spool = Spool::open(options_.spool, 1'000'000).value();
    for (int id = 1; id <= 4; ++id) ASSERT_TRUE(spool->add(small_job(id)));
  }
  const auto path = [&](const std::string& name) { return options_.spool + "/" + name; };
  testing::write_file(path("7-1.window"), testing::read_file(path("7-1.window")).substr(0, 20'000));
  testing::write_file(path("7-2.window"), "nonsense that is no window and no lcm log");
  fs::copy_file(path("7-4.window"), path("7-3.window"), fs::copy_options::overwrite_existing);
  testing::write_file(path("7-9.submap"), "nonsense");
  World world(options_, fake_builder());
  world.run_for(1);
  EXPECT_THAT(world.received, ElementsAre(-4));
  for (const int id : {1, 2, 3, 9}) EXPECT_TRUE(world.announced(id, window_t::FAILED)) << id;
  EXPECT_THAT(left(), IsEmpty());
  EXPECT_THAT(testing::read_file(path("failed/7-1.txt")), HasSubstr("in the middle of an event"));
  EXPECT_THAT(testing::read_file(path("failed/7-3.txt")), HasSubstr("holds window 4"));
  World again(options_, fake_builder());
  again.run_for(1);
  EXPECT_THAT(again.windows, IsEmpty());
}

// Changes the message into one that this version cannot decode, as if another version had written it.
std::string of_another_version(std::string message) {
  message[0] = static_cast<char>(message[0] ^ 0x55);
  return message;
}

TEST_F(RebuildQueueTest, ASpoolOfAnotherVersionIsKeptAndStopsNobody) {
  const auto path = [&](const std::string& name) { return options_.spool + "/" + name; };
  {
    const auto spool = Spool::open(options_.spool, 1'000'000).value();
    for (int id = 1; id <= 3; ++id) ASSERT_TRUE(spool->add(small_job(id)));
    const auto claim = spool->claim({7, 2});
    const std::vector<uint8_t> submap = encode_message(make_submap_update(*fake_result(small_job(2)).submap, 0));
    ASSERT_TRUE(spool->store_submap({7, 2}, submap));
  }
  const std::string window = testing::read_file(path("7-1.window"));
  const size_t manifest = 28 + std::string(kWindowJobChannel).size();  // begins after the event's header
  testing::write_file(path("7-1.window"), window.substr(0, manifest) + of_another_version(window.substr(manifest)));
  const std::string submap = of_another_version(testing::read_file(path("7-2.submap")));
  testing::write_file(path("7-2.submap"), submap);
  options_.failed_mb = 1;
  World world(options_, fake_builder());
  world.run_for(1);
  EXPECT_THAT(world.received, ElementsAre(-3));
  for (const int id : {1, 2}) EXPECT_TRUE(world.announced(id, window_t::FAILED)) << id;
  EXPECT_THAT(left(), IsEmpty());
  EXPECT_THAT(testing::read_file(path("failed/7-1.txt")), HasSubstr("no window_job_t of this version"));
  EXPECT_THAT(testing::read_file(path("failed/7-2.txt")), HasSubstr("no submap_update_t of this version"));
  EXPECT_TRUE(fs::exists(path("failed/7-1.window")));
  EXPECT_EQ(testing::read_file(path("failed/7-2.submap")), submap);
}

TEST_F(RebuildQueueTest, WhatIsLargerThanAnyWindowIsKeptAndStopsNobody) {
  const auto path = [&](const std::string& name) { return options_.spool + "/" + name; };
  {
    const auto spool = Spool::open(options_.spool, 1'000'000).value();
    for (int id = 1; id <= 2; ++id) ASSERT_TRUE(spool->add(small_job(id)));
  }
  testing::write_file(path("7-9.submap"), "x");
  fs::resize_file(path("7-1.window"), static_cast<uintmax_t>(kMaxWindowBytes) + 1);
  fs::resize_file(path("7-9.submap"), kMaxMessageBytes + 1);
  World world(options_, fake_builder());
  world.run_for(1);
  EXPECT_THAT(world.received, ElementsAre(-2));
  EXPECT_THAT(left(), IsEmpty());
  EXPECT_EQ(std::distance(fs::directory_iterator(path("failed")), {}), 2) << "the latest and its reason";
}

TEST_F(RebuildQueueTest, AFullDiskFailsNothing) {
  const int result = testing::run_on_small_disk(folder_.path().string(), 200'000, [&] {
    World world(options_, fake_builder());
    testing::write_file(folder_ / "ballast", std::string(180'000, 'x'));
    for (int id = 1; id <= 3; ++id) world.queue->add(small_job(id));
    world.run_for(2);
    if (world.received != std::vector<int32_t>{-1, -2, -3}) return 1;
    if (world.queue->detail().find("No space left") == std::string::npos) return 2;
    fs::remove(folder_ / "ballast");
    world.queue->add(small_job(4));
    world.run_for(1);
    if (world.received.size() != 4) return 3;
    return world.queue->degraded() ? 4 : 0;
  });
  if (result < 0) GTEST_SKIP() << "no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

// A process is killed at a chosen moment of a window's life, and another process goes on.
class KilledRuminator : public RebuildQueueTest, public ::testing::WithParamInterface<const char*> {
 protected:
  // Runs in a child process, and does not return.
  [[noreturn]] void live_and_die(const std::string& moment) {
    const auto die_at = [&](const std::string& here) {
      if (moment == here) raise(SIGKILL);
    };
    World world(
        options_,
        [&](const WindowJob& job, const std::string& work, const auto&, const auto&) {
          fs::create_directories(work);
          testing::write_file(work + "/database.db", "half");
          die_at("extracting");
          testing::write_file(work + "/colmap.log", "half");
          die_at("mapping");
          return fake_result(job);
        },
        [&](const RuminationWindow&, const BuildResult&) { die_at("built"); });
    world.on_submap = [&] {
      testing::write_file(folder_ / "arrived", "yes");
      die_at("sent");
    };
    world.map_server_answers = moment != "stored";
    if (moment == "queued" && !Spool::open(options_.spool, 1'000'000).value()->add(small_job(1))) _exit(2);
    die_at("queued");
    world.queue->add(small_job(1));
    die_at("stored");
    world.run_for(1);
    die_at("published");
    _exit(1);
  }
};

TEST_P(KilledRuminator, AnotherOneFinishesTheJobOnce) {
  const std::string moment = GetParam();
  const pid_t child = fork();
  if (child == 0) live_and_die(moment);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << status;

  std::atomic<int> built = 0;
  World world(options_, fake_builder(&built));
  world.run_for(1);
  const bool was_built = moment == "stored" || moment == "sent" || moment == "published";
  EXPECT_EQ(built, was_built ? 0 : 1);
  if (moment == "published")
    EXPECT_THAT(world.received, IsEmpty());
  else
    EXPECT_THAT(world.received, ElementsAre(-1));
  EXPECT_THAT(left(), IsEmpty());
  EXPECT_FALSE(fs::exists(folder_ / "spool/7-1.work"));
  EXPECT_EQ(world.queue->last_id(7), 1);
  World third(options_, fake_builder(&built));
  third.run_for(1);
  EXPECT_THAT(third.received, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(AtEachStage, KilledRuminator,
                         ::testing::Values("queued", "extracting", "mapping", "built", "stored", "sent", "published"),
                         [](const auto& moment) { return std::string(moment.param); });

TEST_F(RebuildQueueTest, AJobThatKillsEveryTimeIsGivenUp) {
  for (int i = 0; i < 5; ++i) {
    const pid_t child = fork();
    if (child == 0) {
      World world(options_, [](const WindowJob&, const std::string&, const auto&, const auto&) -> BuildResult {
        raise(SIGKILL);
        return {};
      });
      if (i == 0) world.queue->add(small_job(1));
      world.run_for(1);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(WIFSIGNALED(status) != 0, i < 3) << i;
  }
  EXPECT_THAT(testing::read_file(folder_ / "spool/failed/7-1.txt"), HasSubstr("begun 3 times and never ended"));
}

}  // namespace
}  // namespace rumi::ruminator
