// SPDX-License-Identifier: BSD-3-Clause
#include "base/child/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>

#include "base/or_throw.h"
#include "tests/support/process_state.h"

namespace rumi {
namespace {

using ::testing::HasSubstr;

Child start_shell(const std::string& script) {
  ChildLaunch launch;
  launch.arguments = {"/bin/sh", "-c", script};
  return or_throw(Child::start(launch));
}

std::string all_output(const Child& child) {
  std::string text;
  char buffer[256];
  for (;;) {
    const ssize_t count = read(child.output(), buffer, sizeof(buffer));
    if (count == 0) return text;
    if (count > 0) text.append(buffer, static_cast<size_t>(count));
    pollfd ready{child.output(), POLLIN, 0};
    if (count < 0 && errno == EAGAIN) poll(&ready, 1, 10'000);
  }
}

TEST(Child, SaysWhatItSaysAndHowItEnded) {
  Child child = start_shell("echo out; echo err >&2; exit 7");
  EXPECT_EQ(all_output(child), "out\nerr\n");
  const ChildEnd end = child.reap();
  EXPECT_TRUE(end.exited());
  EXPECT_EQ(end.exit_code(), 7);
  EXPECT_EQ(end.describe(), "ended with exit code 7");
}

TEST(Child, ASignalIsTold) {
  Child child = start_shell("kill -9 $$");
  const ChildEnd end = child.reap();
  EXPECT_FALSE(end.exited());
  EXPECT_TRUE(end.signalled());
  EXPECT_EQ(end.signal(), SIGKILL);
  EXPECT_THAT(end.describe(), HasSubstr("was ended by signal 9"));
}

TEST(Child, AHeldSignalWaitsUntilTheProgramUnblocksIt) {
  for (const bool is_held : {false, true}) {
    ChildLaunch launch;
    launch.arguments = {"sh", "-c", "kill -USR1 $$; exit 7"};
    if (is_held) launch.held_signals = {SIGUSR1};
    Result<Child> child = Child::start(launch);
    ASSERT_TRUE(child) << child.error_text();
    const ChildEnd end = child->reap();
    EXPECT_EQ(end.exited(), is_held) << end.describe();
  }
}

TEST(Child, IsLeftToBeReapedOnceItHasEnded) {
  Child child = start_shell("read line; exit 0");  // stdin is /dev/null: `read` ends at once
  all_output(child);
  ASSERT_TRUE(testing::happens([&child] { return child.has_ended(); }));
  EXPECT_TRUE(child.has_ended()) << "however often one asks";
  EXPECT_EQ(kill(child.pid(), 0), 0) << "its number is still its own";
  EXPECT_TRUE(child.reap().exited());
}

TEST(Child, DiesWithItsOwnerAndSoDoesWhatItStarted) {
  pid_t grandchild = 0;
  {
    Child child = start_shell("sleep 100 & echo $!; wait");
    char buffer[64] = "";
    pollfd ready{child.output(), POLLIN, 0};
    poll(&ready, 1, 10'000);
    ASSERT_GT(read(child.output(), buffer, sizeof(buffer) - 1), 0);
    grandchild = static_cast<pid_t>(std::stol(buffer));
    ASSERT_EQ(kill(grandchild, 0), 0);
  }
  EXPECT_TRUE(testing::ends(grandchild));
}

TEST(Child, WhatCannotBeExecutedIsNoChild) {
  ChildLaunch launch;
  EXPECT_EQ(Child::start(launch).error_text(), "no program is named");
  launch.arguments = {"/etc/hostname-that-is-not-there"};
  EXPECT_THAT(Child::start(launch).error_text(), HasSubstr("No such file"));
}

}  // namespace
}  // namespace rumi
