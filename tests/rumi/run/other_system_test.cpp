// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/other_system.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "bus/process/only_one.h"
#include "bus/transport/memory_bus.h"

namespace rumi::tool {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const WantedPlaces kWanted = {{"map_server", "front_tracker"}, "CAMERA"};

class OtherSystemTest : public testing::Test {
 protected:
  OtherSystemTest() {
    bus_.set_now_us(1'000'000'000);
    bus_.set_tap([this](const std::string&, std::span<const uint8_t> data) {
      process_status_t status;
      const bool is_ours = Bus::decode(data, &status) && status.host != "another";
      if (is_ours && ++questions_ == 1)
        for (const process_status_t& answer : answers_) bus_.publish(channels::kStatus, answer);
      return true;
    });
  }
  // Lets a process on another computer, which was started age_us ago, answer the first question.
  void say(const std::string& process, int64_t age_us, int8_t state = process_status_t::RUNNING,
           const std::string& channel = "") {
    process_status_t status = starting_status(process, bus_.now_us(), bus_.now_us() - age_us);
    status.state = state;
    status.host = "another";
    if (!channel.empty()) status.channels.push_back({channel, 0, 0, 0, 0});
    status.nchannels = static_cast<int32_t>(status.channels.size());
    answers_.push_back(status);
  }
  std::string find() { return find_other_system(bus_, kWanted, std::chrono::milliseconds(20)).error_text(); }
  MemoryBus bus_;
  std::vector<process_status_t> answers_;
  int questions_ = 0;
};

TEST_F(OtherSystemTest, AnEmptyBusIsFree) { EXPECT_EQ(find(), ""); }

TEST_F(OtherSystemTest, WhoIsThereIsNamedWithTheRemedy) {
  say("map_server", 5'000'000);
  EXPECT_THAT(find(), AllOf(HasSubstr("map_server, pid"), HasSubstr("on another, for 5 s"),
                            HasSubstr("--set up.channel_prefix=NAME")));
}

TEST_F(OtherSystemTest, WhoTakesNoPlaceDoesNotMatter) {
  say("viewer_offscreen", 5'000'000);
  say("camera_driver", 5'000'000, process_status_t::RUNNING, "CAMERA_2");
  say("map_server", 5'000'000, process_status_t::STOPPING);
  EXPECT_EQ(find(), "");
}

TEST_F(OtherSystemTest, ADriverOnTheSameChannelTakesThePlace) {
  say("camera_driver", 5'000'000, process_status_t::RUNNING, "CAMERA");
  EXPECT_THAT(find(), HasSubstr("camera_driver"));
}

TEST_F(OtherSystemTest, OfTwoThatAskTheEarlierOneGoesOn) {
  say(kAsksEverybody, 100'000, process_status_t::STARTING);
  EXPECT_THAT(find(), HasSubstr("another system"));
}

TEST_F(OtherSystemTest, TheEarlierOneOfTwoAsksAgainSoThatTheLaterOneHearsIt) {
  say(kAsksEverybody, -100'000, process_status_t::STARTING);
  EXPECT_EQ(find(), "");
  EXPECT_EQ(questions_, 2);
}

}  // namespace
}  // namespace rumi::tool
