// SPDX-License-Identifier: BSD-3-Clause
#include "base/running/stage_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "base/this_process/cpu_clock.h"

namespace rumi {
namespace {

using ::testing::Contains;
using ::testing::Key;

void work(double cpu_s) {
  for (const double until_s = thread_cpu_s() + cpu_s; thread_cpu_s() < until_s;) {
  }
}

TEST(StageClock, AStageWithinAnotherCountsForItselfAlone) {
  const double begin_s = thread_cpu_s();
  {
    const StageClock outer("clock_test.outer");
    work(0.02);
    {
      const StageClock inner("clock_test.inner");
      work(0.05);
    }
    work(0.01);
  }
  const double all_s = thread_cpu_s() - begin_s;
  std::map<std::string, double> cpu_s = stage_cpu_s("clock_test");
  ASSERT_EQ(cpu_s.size(), 2u);
  EXPECT_GE(cpu_s["outer"], 0.03);
  EXPECT_GE(cpu_s["inner"], 0.05);
  EXPECT_LE(cpu_s["outer"] + cpu_s["inner"], all_s);
}

TEST(StageClock, ThreadsAndComponentsAreKeptApart) {
  const StageClock here("clock_test_a.waits");
  std::thread([] {
    const StageClock there("clock_test_a.works");
    work(0.01);
  }).join();
  add_stage_cpu("clock_test_a.child", 7);
  add_stage_cpu("clock_test_b.child", 1);
  std::map<std::string, double> cpu_s = stage_cpu_s("clock_test_a");
  EXPECT_GE(cpu_s["works"], 0.01);
  EXPECT_EQ(cpu_s["child"], 7);
  EXPECT_THAT(cpu_s, testing::Not(Contains(Key("waits")))) << "it goes on";
  EXPECT_EQ(stage_cpu_s("clock_test_b").size(), 1u);
  EXPECT_TRUE(stage_cpu_s("clock").empty());
}

}  // namespace
}  // namespace rumi
