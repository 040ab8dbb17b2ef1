// SPDX-License-Identifier: BSD-3-Clause
#include "base/running/worker.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <stdexcept>
#include <thread>
#include <vector>

namespace rumi {
namespace {

class WorkerTest : public ::testing::TestWithParam<bool> {
 protected:
  bool threaded() const { return GetParam(); }
};

TEST_P(WorkerTest, DoesOneJobAfterAnother) {
  std::vector<int> done;
  std::thread::id where;
  Worker worker(threaded());
  for (int i = 0; i < 100; ++i)
    worker.post([&, i] {
      done.push_back(i);
      where = std::this_thread::get_id();
    });
  worker.wait_until_idle();
  EXPECT_EQ(worker.pending(), 0);
  ASSERT_EQ(done.size(), 100u);
  EXPECT_TRUE(std::is_sorted(done.begin(), done.end()));
  EXPECT_EQ(where != std::this_thread::get_id(), threaded());
  EXPECT_EQ(worker.take_broken().count, 0);
}

TEST_P(WorkerTest, WhatAJobThrowsEndsThatJobAlone) {
  int done = 0;
  Worker worker(threaded());
  worker.post([] { throw std::runtime_error("no such place"); });
  worker.post([&] { ++done; });
  worker.post([] { throw 7; });
  worker.post([&] { ++done; });
  worker.wait_until_idle();
  EXPECT_EQ(done, 2);
  const Worker::Broken broken = worker.take_broken();
  EXPECT_EQ(broken.count, 2);
  EXPECT_EQ(broken.reason, "what was thrown is no std::exception");
  EXPECT_EQ(worker.take_broken().count, 0) << "they were told";
  worker.post([] { throw std::runtime_error("no such place"); });
  worker.wait_until_idle();
  EXPECT_EQ(worker.take_broken().reason, "no such place");
}

INSTANTIATE_TEST_SUITE_P(, WorkerTest, ::testing::Bool(),
                         [](const auto& threaded) { return threaded.param ? "InAThread" : "AtOnce"; });

TEST(Worker, ItsEndWaitsForTheJobAtHand) {
  std::promise<void> begun, go_on;
  std::atomic<int> done = 0;
  std::thread letting_go;
  {
    Worker worker(true);
    worker.post([&] {
      begun.set_value();
      go_on.get_future().wait();
      ++done;
    });
    begun.get_future().wait();
    EXPECT_EQ(worker.pending(), 1);
    letting_go = std::thread([&] { go_on.set_value(); });
  }
  letting_go.join();
  EXPECT_EQ(done, 1);
}

TEST(Worker, ItsThreadHasItsNiceness) {
  int its = -1;
  Worker worker(true, 7);
  worker.post([&] { its = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())); });
  worker.wait_until_idle();
  EXPECT_EQ(its, getpriority(PRIO_PROCESS, 0) + 7);
}

}  // namespace
}  // namespace rumi
