// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/rebuild_queue.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <regex>

#include "tests/ruminator/queue/queue_world.h"
#include "tests/support/captured_log.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using testing::fake_builder;
using testing::fake_result;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kWholeLife;
using ::testing::Not;
using testing::RebuildQueueTest;
using testing::small_job;
using testing::World;

TEST_F(RebuildQueueTest, AWindowLivesFromQueuedToPublished) {
  for (const bool in_spool : {true, false}) {
    if (!in_spool) options_.spool.clear();
    World world(options_, fake_builder());
    world.queue->add(small_job(1));
    world.run_for(1);
    EXPECT_EQ(world.states_of(1), kWholeLife);
    EXPECT_THAT(world.received, ElementsAre(-1));
    EXPECT_EQ(world.queue->pending(), 0);
    EXPECT_FALSE(world.queue->degraded());
    EXPECT_EQ(world.windows.back().ngap, 5);
    EXPECT_EQ(world.windows.back().reason, "a reason");
  }
  EXPECT_THAT(left(), IsEmpty());
}

TEST_F(RebuildQueueTest, WithoutASpoolNothingRemainsOfAFailure) {
  options_.spool.clear();
  std::string used;
  World world(options_, [&](const WindowJob&, const std::string& work, const auto&, const auto&) {
    used = work;
    fs::create_directories(work);
    testing::write_file(work + "/colmap.log", "said COLMAP");
    BuildResult result;
    result.submap = Error{"no model"};
    return result;
  });
  world.queue->add(small_job(1));
  world.run_for(1);
  EXPECT_TRUE(world.announced(1, window_t::FAILED));
  EXPECT_FALSE(used.empty());
  EXPECT_FALSE(fs::exists(used));
}

TEST_F(RebuildQueueTest, InAThreadOfItsOwnAtLowPriority) {
  options_.build_thread = true;
  options_.build.nice = 7;
  std::atomic<int> niceness = -1;
  std::atomic<bool> go = false;
  const int our_niceness = getpriority(PRIO_PROCESS, 0);
  World world(options_, [&](const WindowJob& job, const std::string&, const auto& progress, const auto&) {
    niceness = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
    progress(BuildProgress{BuildStage::kMapping, 0.25, 12.5});
    while (!go) usleep(1000);
    return fake_result(job);
  });
  world.queue->add(small_job(1));
  world.queue->add(small_job(2));
  ASSERT_TRUE(world.run_until([&] { return world.announced(1, window_t::MAPPING); }));
  EXPECT_EQ(niceness, std::min(our_niceness + 7, 19));
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), our_niceness) << "nobody else";
  world.windows.clear();
  world.run_for(3.5);  // while the window is being rebuilt, it is announced every second
  EXPECT_EQ(std::count_if(world.windows.begin(), world.windows.end(),
                          [](const window_t& w) {
                            return w.window_id == 1 && w.state == window_t::MAPPING && w.progress == 0.25f &&
                                   w.remaining_s == 12.5f;
                          }),
            3);
  EXPECT_GE(std::count_if(world.windows.begin(), world.windows.end(),
                          [](const window_t& w) { return w.window_id == 2 && w.state == window_t::QUEUED; }),
            3);
  EXPECT_THAT(world.queue->detail(), HasSubstr("window 1 mapping 25 %, about 12 s left; 1 queued"));
  go = true;
  ASSERT_TRUE(world.run_until([&] { return world.received.size() == 2; }));
  EXPECT_THAT(world.received, ElementsAre(-1, -2));
}

TEST_F(RebuildQueueTest, SaysHowLongAfterTheResumptionItPublishedAlsoWhenTheImagesEnd) {
  options_.build_thread = true;
  std::atomic<bool> go = false;
  World world(options_, [&](const WindowJob& job, const std::string&, const auto&, const auto&) {
    while (!go) usleep(1000);
    return fake_result(job);
  });
  const testing::CapturedLog log;
  const WindowJob job = small_job(1);
  world.queue->set_frame_time(job.window.resumed_utime_us + 1'500'000);  // no image follows
  world.queue->add(job);
  world.run_for(6);
  go = true;
  ASSERT_TRUE(world.run_until([&] { return world.announced(1, window_t::PUBLISHED); }));
  std::smatch seconds;
  const std::string text = log.text();
  ASSERT_TRUE(std::regex_search(text, seconds, std::regex("([0-9.]+) s after tracking resumed"))) << text;
  EXPECT_GE(std::stod(seconds[1]), 7.5);
  EXPECT_THAT(text, HasSubstr(" images rebuilt in "));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << "a window is one line, when it is done: " << text;
}

TEST_F(RebuildQueueTest, AFailureSaysWhyAndIsKept) {
  World world(options_, [](const WindowJob&, const std::string& work, const auto&, const auto&) {
    fs::create_directories(work);
    testing::write_file(work + "/colmap.log", "said COLMAP");
    BuildResult result;
    result.submap = Error{"no model with a gap frame"};
    return result;
  });
  world.queue->add(small_job(1));
  world.run_for(1);
  EXPECT_EQ(world.windows.back().state, window_t::FAILED);
  EXPECT_EQ(world.windows.back().reason, "no model with a gap frame");
  EXPECT_TRUE(read_window_job(folder_ / "spool/failed/7-1.window").has_value());
  EXPECT_THAT(testing::read_file(folder_ / "spool/failed/7-1.log"), HasSubstr("said COLMAP"));
  EXPECT_THAT(left(), IsEmpty());
  EXPECT_THAT(world.queue->detail(), HasSubstr("1 failed"));
  EXPECT_EQ(world.queue->pending(), 0u);
  EXPECT_TRUE(world.queue->finished());
}

TEST_F(RebuildQueueTest, ABuilderThatThrowsOrReturnsNonsenseIsAFailure) {
  int call = 0;
  World world(options_, [&](const WindowJob& job, const std::string&, const auto&, const auto&) {
    if (++call == 1) throw std::runtime_error("out of luck");
    BuildResult result = fake_result(job);
    if (call == 2) result.submap->keyframes[0].cam_from_submap.translation.x() = std::nan("");
    if (call == 3) result = {};
    return result;
  });
  for (int id = 1; id <= 3; ++id) world.queue->add(small_job(id));
  world.run_for(1);
  EXPECT_THAT(world.received, IsEmpty());
  for (int id = 1; id <= 3; ++id) EXPECT_TRUE(world.announced(id, window_t::FAILED)) << id;
  EXPECT_THAT(testing::read_file(folder_ / "spool/failed/7-1.txt"), HasSubstr("out of luck"));
  EXPECT_THAT(testing::read_file(folder_ / "spool/failed/7-2.txt"), HasSubstr("not consistent"));
  EXPECT_THAT(testing::read_file(folder_ / "spool/failed/7-3.txt"), HasSubstr("rebuilding gave nothing"));
}

TEST_F(RebuildQueueTest, WhereTheMachineFailsItIsTriedAgain) {
  options_.build_thread = true;
  std::atomic<int> tries = 0;
  const Builder builder = [&](const WindowJob& job, const std::string&, const auto&, const auto&) {
    ++tries;
    BuildResult result;
    if (job.window.id == 2 && tries == 5) return fake_result(job);
    result.submap = Error{"colmap: not found"};
    result.retryable = true;
    return result;
  };
  World world(options_, builder);
  world.queue->add(small_job(1));
  ASSERT_TRUE(world.run_until([&] { return world.announced(1, window_t::FAILED); }));
  EXPECT_EQ(tries, 3);
  EXPECT_THAT(world.windows.back().reason, HasSubstr("colmap: not found"));
  world.queue->add(small_job(2));
  ASSERT_TRUE(world.run_until([&] { return !world.received.empty(); }));
  EXPECT_EQ(tries, 5);
  EXPECT_THAT(world.received, ElementsAre(-2));
}

TEST_F(RebuildQueueTest, WithoutMapServerTheSubmapWaitsAndIsSentAgain) {
  World world(options_, fake_builder());
  world.map_server_answers = false;
  world.queue->add(small_job(1));
  world.run_for(100);
  EXPECT_TRUE(world.queue->degraded());
  EXPECT_THAT(world.queue->detail(), HasSubstr("1 back submaps wait for map_server (no answer from anyone"));
  EXPECT_FALSE(world.announced(1, window_t::PUBLISHED));
  EXPECT_THAT(left(), ElementsAre("7-1.submap"));
  world.map_server_answers = true;
  world.run_for(5);
  EXPECT_TRUE(world.announced(1, window_t::PUBLISHED));
  EXPECT_FALSE(world.queue->degraded());
  EXPECT_THAT(left(), IsEmpty());
}

TEST_F(RebuildQueueTest, WhatMapServerRefusesIsKeptAndOfferedAgain) {
  World world(options_, fake_builder());
  world.refusal = "disk full";
  world.queue->add(small_job(1));
  world.run_for(1);
  EXPECT_THAT(world.queue->detail(), HasSubstr("disk full"));
  EXPECT_THAT(left(), ElementsAre("7-1.submap"));
  world.refusal.clear();
  world.run_for(3);
  EXPECT_THAT(world.received, ElementsAre(-1));
  EXPECT_THAT(left(), IsEmpty());
}

TEST_F(RebuildQueueTest, StoppingKeepsEverythingForTheNextStart) {
  options_.build_thread = true;
  {
    std::atomic<bool> begun = false;
    World world(options_, [&](const WindowJob&, const std::string&, const auto&, const std::atomic<bool>& cancel) {
      begun = true;
      while (!cancel) usleep(1000);
      BuildResult result;
      result.cancelled = true;
      return result;
    });
    world.queue->add(small_job(1));
    world.queue->add(small_job(2));
    ASSERT_TRUE(world.run_until([&] { return begun.load(); }));
    EXPECT_FALSE(world.queue->finished());
    world.queue->stop();
    ASSERT_TRUE(world.run_until([&] { return world.queue->finished(); }));
    EXPECT_THAT(world.received, IsEmpty());
    EXPECT_THAT(world.windows.back().reason, HasSubstr("will be tried again at the next start"));
  }
  EXPECT_THAT(left(), ::testing::IsSupersetOf({"7-1.window", "7-2.window"}));
  std::atomic<int> built = 0;
  World world(options_, fake_builder(&built));
  EXPECT_EQ(world.queue->pending(), 2);
  world.queue->finish();
  ASSERT_TRUE(world.run_until([&] { return world.queue->finished(); }));
  EXPECT_THAT(world.received, ElementsAre(-1, -2));
  EXPECT_EQ(built, 2);
  EXPECT_THAT(left(), IsEmpty());
}

TEST_F(RebuildQueueTest, FinishingDoesNotWaitForWhatCannotBe) {
  options_.build_thread = true;
  World world(options_, [&](const WindowJob& job, const std::string&, const auto&, const auto&) {
    BuildResult result = fake_result(job);
    if (job.window.id != 1) return result;
    result.retryable = true;
    result.submap = Error{"no colmap"};
    return result;
  });
  world.refusal = "disk full";
  for (int id = 1; id <= 3; ++id) world.queue->add(small_job(id));
  world.queue->finish();
  ASSERT_TRUE(world.run_until([&] { return world.queue->finished(); }));
  EXPECT_THAT(left(), ::testing::IsSupersetOf({"7-1.window", "7-2.submap", "7-3.submap"}));
}

TEST_F(RebuildQueueTest, SaysWhatItWaitsForWhileItFinishes) {
  World world(options_, fake_builder());
  world.map_server_answers = false;
  world.queue->add(small_job(1));
  EXPECT_EQ(world.queue->waits_for(), "map_server has not taken the back submap of window 1");
  world.map_server_answers = true;
  ASSERT_TRUE(world.run_until([&] { return world.queue->finished(); }));
  EXPECT_EQ(world.queue->waits_for(), "");
}

TEST_F(RebuildQueueTest, TheNumberOfWaitingWindowsIsBoundedTheOldestGoes) {
  options_.build_thread = true;
  options_.max_queued_windows = 2;
  std::atomic<bool> go = false, begun = false;
  World world(options_, [&](const WindowJob& job, const std::string&, const auto&, const auto&) {
    begun = true;
    while (!go) usleep(1000);
    return fake_result(job);
  });
  world.queue->add(small_job(1));
  ASSERT_TRUE(world.run_until([&] { return begun.load(); }));
  for (int id = 2; id <= 5; ++id) world.queue->add(small_job(id));
  world.tick();
  EXPECT_TRUE(world.announced(2, window_t::FAILED));
  EXPECT_TRUE(world.announced(3, window_t::FAILED));
  EXPECT_TRUE(fs::exists(folder_ / "spool/failed/7-2.window"));
  go = true;
  ASSERT_TRUE(world.run_until([&] { return world.received.size() == 3; }));
  EXPECT_THAT(world.received, ElementsAre(-1, -4, -5));
}

}  // namespace
}  // namespace rumi::ruminator
