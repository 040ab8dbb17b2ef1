// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/other_system.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/process/only_one.h"
#include "bus/transport/memory_bus.h"

namespace rumi::tool {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const WantedPlaces kWanted = {{"map_server", "front_tracker"}, "CAMERA"};

class OtherSystemTest : public testing::Test {
 protected:
  OtherSystemTest() { bus_.set_now_us(1'000'000'000); }
  // Somebody on another computer, who was there before the question, or came after it.
  void say(const std::string& process, int64_t age_us, int8_t state = process_status_t::RUNNING,
           const std::string& channel = "") {
    process_status_t status = starting_status(process, bus_.now_us(), bus_.now_us() - age_us);
    status.state = state;
    status.host = "another";
    if (!channel.empty()) status.channels.push_back({channel, 0, 0, 0, 0});
    status.nchannels = static_cast<int32_t>(status.channels.size());
    bus_.publish(channels::kStatus, status);
  }
  std::string find() { return find_other_system(bus_, kWanted, std::chrono::milliseconds(20)); }
  MemoryBus bus_;
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
  int questions = 0;
  bus_.set_tap([&](const std::string&, std::span<const uint8_t> data) {
    process_status_t status;
    if (Bus::decode(data, &status) && status.host != "another") ++questions;
    return true;
  });
  say(kAsksEverybody, -100'000, process_status_t::STARTING);
  EXPECT_EQ(find(), "");
  EXPECT_EQ(questions, 2);
}

}  // namespace
}  // namespace rumi::tool
