// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/only_one.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vector>

#include "base/this_process/process_name.h"
#include "bus/transport/memory_bus.h"

namespace rumi {
namespace {

using testing::HasSubstr;

constexpr int64_t kBeginUs = 1'000'000'000;

class OnlyOneTest : public testing::Test {
 protected:
  OnlyOneTest() { bus_.set_now_us(kBeginUs); }
  // Returns the status of a process on another computer that began `age_us` ago.
  process_status_t other(const std::string& process, int64_t age_us) const {
    process_status_t status = starting_status(process, bus_.now_us(), bus_.now_us() - age_us);
    status.state = process_status_t::RUNNING;
    status.host = "another";
    status.pid = 12;
    return status;
  }
  void hear(const process_status_t& status) {
    bus_.publish(channels::kStatus, status);
    bus_.dispatch();
  }
  MemoryBus bus_;
};

TEST_F(OnlyOneTest, TheLaterOneEndsAndSaysWhatToDo) {
  OnlyOne later(bus_, "map_server", "");
  bus_.set_now_us(kBeginUs + 50'000);
  hear(other("map_server", 7'000'000));
  EXPECT_THAT(later.problem(), HasSubstr("another map_server is on this bus (map_server, pid 12 on another, for 7 s)"));
  EXPECT_THAT(later.problem(), HasSubstr("--channel-prefix NAME"));
}

TEST_F(OnlyOneTest, TheEarlierOneGoesOnAndAnswersAtOnce) {
  OnlyOne earlier(bus_, "map_server", "");
  bus_.set_now_us(kBeginUs + 2'000'000);
  process_status_t question = other("map_server", 0);
  question.state = process_status_t::STARTING;
  hear(question);
  EXPECT_EQ(earlier.problem(), "");
  EXPECT_TRUE(earlier.take_question());
  EXPECT_FALSE(earlier.take_question());
}

TEST_F(OnlyOneTest, OneThatHasSettledNeverEndsWhateverTheClockDoes) {
  OnlyOne settled(bus_, "map_server", "");
  bus_.set_now_us(kBeginUs + 10'000'000);
  hear(other("map_server", 3600'000'000));
  EXPECT_EQ(settled.problem(), "");
  EXPECT_THAT(settled.take_warning(), HasSubstr("what both say will be mixed up"));
  hear(other("map_server", 3600'000'000));
  EXPECT_EQ(settled.take_warning(), "") << "once";
}

TEST_F(OnlyOneTest, OneWhoseClockWasSetBackIsNotTakenForALaterOne) {
  OnlyOne later(bus_, "map_server", "");
  bus_.set_now_us(kBeginUs + 50'000);
  hear(other("map_server", -5'000'000));
  EXPECT_THAT(later.problem(), HasSubstr("another map_server"));
}

TEST_F(OnlyOneTest, OthersDoNotMatter) {
  OnlyOne one(bus_, "map_server", "");
  bus_.set_now_us(kBeginUs + 50'000);
  hear(other("front_tracker", 7'000'000));
  process_status_t ending = other("map_server", 7'000'000);
  ending.state = process_status_t::STOPPING;
  hear(ending);
  process_status_t own = other("map_server", 7'000'000);
  own.host = host_name();
  own.pid = getpid();
  hear(own);
  EXPECT_EQ(one.problem(), "");
}

TEST_F(OnlyOneTest, TheLastWordsOfOneThatWasKilledDoNotMatter) {
  const pid_t dead = fork();
  if (dead == 0) _exit(0);
  waitpid(dead, nullptr, 0);
  OnlyOne restarted(bus_, "map_server", "");
  process_status_t last_words = other("map_server", 7'000'000);
  last_words.host = host_name();
  last_words.pid = dead;
  hear(last_words);
  EXPECT_EQ(restarted.problem(), "");
}

TEST_F(OnlyOneTest, TwoCamerasMayPublishOnTwoChannels) {
  OnlyOne left(bus_, "camera_driver", "LEFT");
  bus_.set_now_us(kBeginUs + 50'000);
  process_status_t right = other("camera_driver", 7'000'000);
  right.nchannels = 1;
  right.channels = {{"RIGHT", 0, 0, 0, 0}};
  hear(right);
  EXPECT_EQ(left.problem(), "");
  right.channels = {{"LEFT", 0, 0, 0, 0}};
  hear(right);
  EXPECT_THAT(left.problem(), HasSubstr("publishes on LEFT"));
  EXPECT_THAT(left.problem(), HasSubstr("--channel NAME"));
}

TEST_F(OnlyOneTest, TheQuestionNamesTheChannel) {
  std::vector<process_status_t> heard;
  bus_.subscribe<process_status_t>(channels::kStatus, {}, [&](const process_status_t& m) { heard.push_back(m); });
  OnlyOne one(bus_, "camera_driver", "LEFT");
  one.ask();
  bus_.dispatch();
  ASSERT_EQ(heard.size(), 1);
  EXPECT_EQ(heard[0].state, process_status_t::STARTING);
  ASSERT_EQ(heard[0].nchannels, 1);
  EXPECT_EQ(heard[0].channels[0].channel, "LEFT");
}

}  // namespace
}  // namespace rumi
