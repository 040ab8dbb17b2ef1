// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/rebuild_queue.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <limits>
#include <regex>
#include <sstream>

#include "bus/transport/memory_bus.h"
#include "bus/wire/submap_update.h"
#include "tests/ruminator/test_jobs.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using testing::fake_builder;
using testing::fake_result;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::small_job;

constexpr int64_t kStepUs = 20'000;

// A bus with a map_server that stores everything, unless it is told otherwise.
class World {
 public:
  explicit World(const RebuildQueueOptions& options, Builder builder, RebuildQueue::BuiltHandler on_built = {}) {
    bus.set_now_us(1'000'000);
    bus.subscribe<window_t>(channels::kWindow, {}, [this](const window_t& w) { windows.push_back(w); });
    bus.set_tap([this](const std::string& channel, std::span<const uint8_t>) {
      return map_server_answers || channel != channels::kSubmapAck;
    });
    receiver.emplace(bus, channels::kSubmap, channels::kSubmapAck, "map_server", true,
                     [this](const ChunkReceiver::Payload& payload) { return on_payload(payload); });
    queue.emplace(bus, options, std::move(builder), std::move(on_built));
  }
  void tick() {
    bus.set_now_us(bus.now_us() + kStepUs);
    queue->tick(bus.now_us());
    bus.dispatch();
    receiver->tick(bus.now_us());
    bus.dispatch();
  }
  void run_for(double seconds) {
    for (const int64_t end = bus.now_us() + static_cast<int64_t>(seconds * 1e6); bus.now_us() < end;) tick();
  }
  // The builder's thread takes real time. False after 20 s.
  bool run_until(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      tick();
      usleep(1000);
    }
    return true;
  }
  std::vector<int> states_of(int32_t id) const {  // without repetitions
    std::vector<int> states;
    for (const window_t& w : windows)
      if (w.window_id == id && (states.empty() || states.back() != w.state)) states.push_back(w.state);
    return states;
  }
  bool announced(int32_t id, int8_t state) const {
    return std::any_of(windows.begin(), windows.end(),
                       [&](const window_t& w) { return w.window_id == id && w.state == state; });
  }

  MemoryBus bus;
  std::vector<window_t> windows;
  std::vector<int32_t> received;  // submap ids
  bool map_server_answers = true;
  std::string refusal;
  std::function<void()> on_submap;
  std::optional<ChunkReceiver> receiver;
  std::optional<RebuildQueue> queue;

 private:
  ChunkReceiver::Verdict on_payload(const ChunkReceiver::Payload& payload) {
    submap_update_t update;
    EXPECT_TRUE(Bus::decode(payload.bytes, &update));
    EXPECT_EQ(update.kind, submap_update_t::BACK);
    if (on_submap) on_submap();
    if (!refusal.empty()) return {false, refusal, 0};
    received.push_back(update.submap_id);
    return {true, "", update.revision};
  }
};

class RebuildQueueTest : public ::testing::Test {
 protected:
  RebuildQueueTest() {
    options_.spool = folder_ / "spool";
    options_.build_thread = false;
    options_.retry_s = 2;
  }
  // Names in the spool that are not ids.
  std::vector<std::string> left() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / "spool"))
      if (entry.is_regular_file() && entry.path().extension() != ".id") names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  testing::TemporaryFolder folder_;
  RebuildQueueOptions options_;
};

const std::vector<int> kWholeLife = {window_t::QUEUED, window_t::EXTRACTING, window_t::MATCHING, window_t::MAPPING,
                                     window_t::PUBLISHED};

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
    result.failure = "no model";
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
  world.run_for(3.5);  // while it works: everything once a second
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
  std::ostringstream said;
  const auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(said);
  spdlog::default_logger()->sinks().push_back(sink);
  const WindowJob job = small_job(1);
  world.queue->set_frame_time(job.window.resumed_utime_us + 1'500'000);  // and no image follows
  world.queue->add(job);
  world.run_for(6);
  go = true;
  ASSERT_TRUE(world.run_until([&] { return world.announced(1, window_t::PUBLISHED); }));
  spdlog::default_logger()->sinks().pop_back();
  std::smatch seconds;
  const std::string text = said.str();
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
    result.failure = "no model with a gap frame";
    return result;
  });
  world.queue->add(small_job(1));
  world.run_for(1);
  EXPECT_EQ(world.windows.back().state, window_t::FAILED);
  EXPECT_EQ(world.windows.back().reason, "no model with a gap frame");
  EXPECT_TRUE(read_window_job(folder_ / "spool/failed/7-1.window").ok());
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
    if (call == 3) result.submap.reset();
    return result;
  });
  for (int id = 1; id <= 3; ++id) world.queue->add(small_job(id));
  world.run_for(1);
  EXPECT_THAT(world.received, IsEmpty());
  for (int id = 1; id <= 3; ++id) EXPECT_TRUE(world.announced(id, window_t::FAILED)) << id;
  EXPECT_THAT(testing::read_file(folder_ / "spool/failed/7-1.txt"), HasSubstr("out of luck"));
  EXPECT_THAT(testing::read_file(folder_ / "spool/failed/7-2.txt"), HasSubstr("not consistent"));
}

TEST_F(RebuildQueueTest, WhereTheMachineFailsItIsTriedAgain) {
  options_.build_thread = true;
  std::atomic<int> tries = 0;
  const Builder builder = [&](const WindowJob& job, const std::string&, const auto&, const auto&) {
    ++tries;
    BuildResult result;
    if (job.window.id == 2 && tries == 5) return fake_result(job);
    result.failure = "colmap: not found";
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
  EXPECT_TRUE(world.announced(2, window_t::QUEUED) || world.queue->pending() == 2);
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
    result.submap.reset();
    result.retryable = true;
    result.failure = "no colmap";
    return result;
  });
  world.refusal = "disk full";
  for (int id = 1; id <= 3; ++id) world.queue->add(small_job(id));
  world.queue->finish();
  ASSERT_TRUE(world.run_until([&] { return world.queue->finished(); }));
  EXPECT_THAT(left(), ::testing::IsSupersetOf({"7-1.window", "7-2.submap", "7-3.submap"}));
}

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
    std::string error;
    const auto spool = Spool::open(options_.spool, 1'000'000, &error);
    for (int id = 1; id <= 4; ++id) spool->add(small_job(id), &error);
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

// As a program with other wire types would have left them.
std::string of_another_version(std::string message) {
  message[0] = static_cast<char>(message[0] ^ 0x55);
  return message;
}

TEST_F(RebuildQueueTest, ASpoolOfAnotherVersionIsKeptAndStopsNobody) {
  const auto path = [&](const std::string& name) { return options_.spool + "/" + name; };
  {
    std::string error;
    const auto spool = Spool::open(options_.spool, 1'000'000, &error);
    for (int id = 1; id <= 3; ++id) spool->add(small_job(id), &error);
    const auto claim = spool->claim({7, 2});
    const std::vector<uint8_t> submap = encode_message(make_submap_update(*fake_result(small_job(2)).submap, 0));
    spool->store_submap({7, 2}, submap);
  }
  const std::string window = testing::read_file(path("7-1.window"));
  const size_t manifest = 28 + std::string(kWindowJobChannel).size();  // after the header of the event
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
    std::string error;
    const auto spool = Spool::open(options_.spool, 1'000'000, &error);
    for (int id = 1; id <= 2; ++id) spool->add(small_job(id), &error);
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

// kill -9 at a chosen moment of a window's life; then another process goes on.
class KilledRuminator : public RebuildQueueTest, public ::testing::WithParamInterface<const char*> {
 protected:
  // In a child, which does not return.
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
    std::string error;
    if (moment == "queued") Spool::open(options_.spool, 1'000'000, &error)->add(small_job(1), &error);
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
