// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/safe_node.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bus/transport/memory_bus.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/process_status_t.hpp"

namespace rumi {
namespace {

class BrokenNode : public Node {
 public:
  void tick(int64_t) override {
    ++ticks;
    if (ticks_break) throw std::runtime_error("a wheel is missing");
  }
  int64_t next_tick_us(int64_t now_us) const override { return now_us; }  // the node wants its tick at once
  NodeStatus status() override {
    if (status_breaks) throw std::runtime_error("no words");
    return {"on its way", false, 42, 1.5};
  }
  void finish() override { throw std::runtime_error("no brakes"); }
  int ticks = 0;
  bool ticks_break = false, status_breaks = false;
};

class SafeNodeTest : public testing::Test {
 protected:
  // Runs the node for a second as run_process() does: with as many ticks as it wants.
  void run_for_a_second() {
    for (const int64_t end_us = now_us_ + 1'000'000; now_us_ < end_us;) {
      now_us_ = std::max(now_us_ + 1'000, safe_.next_tick_us(now_us_));
      safe_.tick(now_us_);
    }
  }
  BrokenNode* node_ = new BrokenNode;
  MemoryBus bus_;
  SafeNode safe_{std::unique_ptr<Node>(node_), &bus_.broken_handlers()};
  int64_t now_us_ = 1'000'000;
};

TEST_F(SafeNodeTest, IsTheNodeAsLongAsNothingIsThrown) {
  run_for_a_second();
  EXPECT_EQ(node_->ticks, 1000);
  const NodeStatus status = safe_.status();
  EXPECT_EQ(status.detail, "on its way");
  EXPECT_FALSE(status.degraded);
  EXPECT_EQ(status.last_utime_us, 42);
}

TEST_F(SafeNodeTest, ATickThatThrowsIsToldAndTheNextOneWaits) {
  node_->ticks_break = true;
  run_for_a_second();
  EXPECT_GE(node_->ticks, 9) << "it goes on";
  EXPECT_LE(node_->ticks, 11) << "but not as fast as it can";
  EXPECT_EQ(safe_.failures().count(), node_->ticks);
  NodeStatus status = safe_.status();
  EXPECT_TRUE(status.degraded);
  EXPECT_EQ(status.detail,
            "on its way; a step broke off (" + std::to_string(node_->ticks) + " so far): a wheel is missing");
  node_->ticks_break = false;
  run_for_a_second();
  status = safe_.status();
  EXPECT_FALSE(status.degraded) << "it is over";
  EXPECT_NE(status.detail.find("a wheel is missing"), std::string::npos);
  EXPECT_GT(node_->ticks, 800);
}

TEST_F(SafeNodeTest, AClockThatGoesBackDoesNotSilenceIt) {
  node_->ticks_break = true;
  safe_.tick(now_us_);
  safe_.tick(now_us_ - 900'000);
  EXPECT_EQ(node_->ticks, 2);
}

TEST_F(SafeNodeTest, TheOtherStepsAreSafeToo) {
  safe_.finish();
  safe_.stop();
  EXPECT_EQ(safe_.failures().count(), 2);
  node_->status_breaks = true;
  const NodeStatus status = safe_.status();
  EXPECT_TRUE(status.degraded);
  EXPECT_EQ(status.detail, "a step broke off (3 so far): no words");
}

// The handler throws for each message. The messages do not count as undecodable, and the log has one line a minute.
TEST_F(SafeNodeTest, AHandlerThatThrowsIsToldInTheStatusAndOnceInTheLog) {
  bus_.subscribe<map_request_t>("A", {}, [](const map_request_t&) { throw std::runtime_error("no hands"); });
  testing::internal::CaptureStderr();
  for (int i = 0; i < 100; ++i) {
    bus_.set_now_us(now_us_ + i * 10'000);
    bus_.publish("A", map_request_t{});
    bus_.dispatch();
  }
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_EQ(log.find("no hands"), log.rfind("no hands")) << log;
  EXPECT_EQ(bus_.counts().at(0).undecodable, 0);
  NodeStatus status = safe_.status();
  EXPECT_TRUE(status.degraded);
  EXPECT_EQ(status.detail, "on its way; the handling of a message broke off (100 so far): A: no hands");
  EXPECT_FALSE(safe_.status().degraded) << "it is over";
}

TEST_F(SafeNodeTest, OnTheBusItIsDegradedWhileItHappens) {
  std::vector<int> states;
  bus_.subscribe<process_status_t>(channels::kStatus, {},
                                   [&](const process_status_t& m) { states.push_back(m.state); });
  StatusPublisher publisher(bus_, "tester");
  for (const bool breaks : {false, true, true, false}) {
    node_->ticks_break = breaks;
    run_for_a_second();
    publisher.tick(safe_, now_us_);
    bus_.dispatch();
  }
  EXPECT_EQ(states, (std::vector<int>{process_status_t::RUNNING, process_status_t::DEGRADED, process_status_t::DEGRADED,
                                      process_status_t::RUNNING}));
}

}  // namespace
}  // namespace rumi
