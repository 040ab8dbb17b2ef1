// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/intake.h"

#include <gmock/gmock.h>

#include "bus/transport/memory_bus.h"
#include "tests/ruminator/test_jobs.h"

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::small_job;

class IntakeTest : public ::testing::Test {
 protected:
  IntakeTest() {
    bus_.set_now_us(1'000'000);
    bus_.subscribe<window_t>(channels::kWindow, {}, [this](const window_t& w) { announced_.push_back(w); });
    options_.spool = folder_ / "spool";
  }
  void start() {
    windows_.emplace(bus_, options_.spool, 1'000'000);
    intake_.emplace(bus_, *windows_, options_);
  }
  std::vector<int> ids() const {
    std::vector<int> ids;
    for (const QueueEntry& entry : windows_->entries()) ids.push_back(entry.name.window_id);
    return ids;
  }

  testing::TemporaryFolder folder_;
  MemoryBus bus_;
  RebuildQueueOptions options_;
  std::optional<QueuedWindows> windows_;
  std::optional<Intake> intake_;
  std::vector<window_t> announced_;
};

TEST_F(IntakeTest, AWindowGoesIntoTheSpoolOrIntoMemory) {
  start();
  EXPECT_TRUE(intake_->add(small_job(1)));
  EXPECT_TRUE(windows_->entries().front().spooled());
  EXPECT_THAT(windows_->spool()->waiting(), ElementsAre(JobName{7, 1}));
  options_.spool.clear();
  start();
  EXPECT_TRUE(intake_->add(small_job(1)));
  EXPECT_TRUE(windows_->entries().front().memory());
  bus_.dispatch();
  ASSERT_EQ(announced_.size(), 2U);
  EXPECT_EQ(announced_[0].state, window_t::QUEUED);
}

TEST_F(IntakeTest, AWindowThatTheSpoolKnowsIsNotTaken) {
  start();
  EXPECT_TRUE(intake_->add(small_job(1)));
  EXPECT_FALSE(intake_->add(small_job(1)));
  EXPECT_THAT(ids(), ElementsAre(1));
}

TEST_F(IntakeTest, WhatAnEarlierProcessLeftIsAdopted) {
  {
    const auto spool = Spool::open(options_.spool, 1'000'000).value();
    for (int id = 1; id <= 3; ++id) ASSERT_TRUE(spool->add(small_job(id)));
    const auto claim = spool->claim({7, 2});
    ASSERT_TRUE(spool->store_submap({7, 2}, std::vector<uint8_t>{1, 2, 3}));
  }
  start();
  EXPECT_THAT(ids(), ElementsAre(2, 1, 3));
  EXPECT_TRUE(windows_->entries().front().is<Built>());
  EXPECT_TRUE(windows_->entries().back().is<Waiting>());
}

TEST_F(IntakeTest, AWindowThatComesLaterIsAdoptedInItsTime) {
  start();
  const auto spool = Spool::open(options_.spool, 1'000'000).value();
  ASSERT_TRUE(spool->add(small_job(4)));
  intake_->tick(bus_.now_us() + 1'000'000);
  EXPECT_THAT(ids(), IsEmpty());
  intake_->tick(bus_.now_us() + 20'000'000);
  EXPECT_THAT(ids(), ElementsAre(4));
}

TEST_F(IntakeTest, TheOldestOfTooManyIsDropped) {
  options_.max_queued_windows = 2;
  start();
  for (int id = 1; id <= 3; ++id) intake_->add(small_job(id));
  EXPECT_THAT(ids(), ElementsAre(2, 3));
  EXPECT_EQ(windows_->failed(), 1);
  bus_.dispatch();
  EXPECT_EQ(announced_.back().state, window_t::FAILED);
  EXPECT_THAT(announced_.back().reason, HasSubstr("dropped before it was rebuilt: 3 windows wait"));
}

TEST_F(IntakeTest, ARefusedWindowIsAnnouncedAndNotQueued) {
  start();
  intake_->refuse(small_job(5).window, "no image of it was kept");
  bus_.dispatch();
  ASSERT_EQ(announced_.size(), 1U);
  EXPECT_EQ(announced_[0].state, window_t::FAILED);
  EXPECT_EQ(announced_[0].reason, "no image of it was kept");
  EXPECT_THAT(ids(), IsEmpty());
}

}  // namespace
}  // namespace rumi::ruminator
