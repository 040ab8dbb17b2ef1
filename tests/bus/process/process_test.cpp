// SPDX-License-Identifier: BSD-3-Clause
// Tests the parts of process.h that need no network; lcm_process_test.cpp has the others.
#include "bus/process/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/running/stage_clock.h"
#include "base/this_process/process_name.h"
#include "bus/transport/lcm_bus.h"
#include "bus/transport/memory_bus.h"
#include "lcmtypes/rumi/process_status_t.hpp"

namespace rumi {
namespace {

using testing::HasSubstr;

class IdleNode : public Node {
 public:
  void tick(int64_t) override {}
  NodeStatus status() override { return {"idle", degraded, 42, 1.5, 3}; }
  bool degraded = false;
};

class StatusTest : public testing::Test {
 protected:
  StatusTest() {
    bus_.subscribe<process_status_t>(channels::kStatus, {}, [this](const process_status_t& m) { seen_.push_back(m); });
  }
  void tick(int64_t now_us) {
    bus_.set_now_us(now_us);
    publisher_.tick(node_, now_us);
    bus_.dispatch();
  }
  MemoryBus bus_;
  IdleNode node_;
  int64_t lost_ = 0;
  StatusPublisher publisher_{bus_, "tester", [this] { return lost_; }};
  std::vector<process_status_t> seen_;
};

TEST_F(StatusTest, OncePerSecondOfTheBusClock) {
  for (int i = 0; i < 100; ++i) tick(5'000'000 + i * 50'000);
  ASSERT_EQ(seen_.size(), 5u);
  EXPECT_EQ(seen_[1].utime, 6'000'000);
  EXPECT_EQ(seen_[1].started_utime, 5'000'000);
}

TEST_F(StatusTest, ImagesThatTheNodeRefusesAreDropped) {
  bus_.subscribe_raw(channels::kCamera, {}, [](auto) { return true; });
  tick(5'000'000);
  for (const channel_count_t& channel : seen_.at(0).channels)
    EXPECT_EQ(channel.dropped, channel.channel == channels::kCamera ? 3 : 0) << channel.channel;
}

TEST_F(StatusTest, AClockThatGoesBackDoesNotSilenceIt) {
  tick(5'000'000);
  tick(1'000'000);
  EXPECT_EQ(seen_.size(), 2u);
}

TEST_F(StatusTest, SaysWhatWasLostBeforeItWasReceivedAndWhatHelps) {
  tick(1'000'000);
  lost_ = 3;
  tick(2'000'000);
  tick(3'000'000);
  ASSERT_EQ(seen_.size(), 3u);
  EXPECT_EQ(seen_[0].detail, "idle");
  EXPECT_EQ(seen_[1].state, process_status_t::DEGRADED);
  EXPECT_THAT(seen_[1].detail, HasSubstr("3 datagrams lost before they were received"));
  EXPECT_THAT(seen_[1].detail, HasSubstr("sudo sysctl -w net.core.rmem_max="));
  EXPECT_EQ(seen_[2].state, process_status_t::RUNNING) << "it is over";
  EXPECT_EQ(seen_[2].detail, "idle; 3 datagrams lost before they were received");
}

TEST_F(StatusTest, SaysWhatTheNodeAndTheBusSay) {
  add_stage_cpu("tester.draw", 2);
  add_stage_cpu("test.draw", 3);
  tick(1'000'000);
  node_.degraded = true;
  tick(2'000'000);
  publisher_.stopping(node_, 2'500'000);
  bus_.dispatch();
  ASSERT_EQ(seen_.size(), 3u);
  EXPECT_EQ(seen_[0].state, process_status_t::RUNNING);
  EXPECT_EQ(seen_[1].state, process_status_t::DEGRADED);
  EXPECT_EQ(seen_[2].state, process_status_t::STOPPING);
  const process_status_t& s = seen_[1];
  EXPECT_EQ(s.process, "tester");
  EXPECT_EQ(s.detail, "idle");
  EXPECT_EQ(s.last_utime, 42);
  EXPECT_EQ(s.processing_ms, 1.5f);
  EXPECT_EQ(s.version, version());
  EXPECT_EQ(s.messages_out, 1);
  EXPECT_EQ(s.messages_in, 1);
  ASSERT_EQ(s.nchannels, 1);
  EXPECT_EQ(s.channels[0].channel, channels::kStatus);
  EXPECT_GT(s.cpu_s, 0);
  ASSERT_EQ(s.nstages, 1);
  EXPECT_EQ(s.stages[0].stage, "draw");
  EXPECT_EQ(s.stages[0].cpu_s, 2);
  EXPECT_GT(s.rss_bytes, 1'000'000);
}

TEST(ProcessTest, NamesAreUniqueAmongProcesses) {
  EXPECT_THAT(unique_process_name("viewer"), testing::StartsWith("viewer@"));
  EXPECT_THAT(unique_process_name("viewer"), testing::EndsWith(":" + std::to_string(getpid())));
}

TEST(ChannelNamesTest, PrefixAndCameraName) {
  const ChannelNames names{"robot1/", "LEFT"};
  EXPECT_EQ(names.on_wire(channels::kCamera), "robot1/LEFT");
  EXPECT_EQ(names.on_wire(channels::kTrack), "robot1/RUMI_TRACK");
  EXPECT_EQ(ChannelNames().on_wire(channels::kCamera), "CAMERA");
}

TEST(LcmAdviceTest, NamesTheAddressOfTheUrl) {
  EXPECT_THAT(multicast_advice("udpm://239.1.2.3:7000?ttl=0"), HasSubstr("sudo ip route add 239.1.2.3/32 dev lo"));
  EXPECT_THAT(multicast_advice("udpm://"), HasSubstr("sudo ip route add 239.255.76.67/32 dev lo"));
  EXPECT_THAT(multicast_advice("udpm://?ttl=1"), HasSubstr("sudo ip link set lo multicast on"));
}

TEST(LcmAdviceTest, WarnsOfASmallReceiveBuffer) {
  EXPECT_EQ(receive_buffer_advice(kDefaultLcmUrl, 4194304), "");
  EXPECT_THAT(receive_buffer_advice(kDefaultLcmUrl, 212992), HasSubstr("sudo sysctl -w net.core.rmem_max=2097152"));
  EXPECT_THAT(receive_buffer_advice("udpm://239.255.76.67:7667", 4194304), HasSubstr("recv_buf_size=2097152"));
}

}  // namespace
}  // namespace rumi
