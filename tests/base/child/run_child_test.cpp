// SPDX-License-Identifier: BSD-3-Clause
#include "base/child/run_child.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/process_state.h"
#include "tests/support/temporary_folder.h"

namespace rumi::ruminator {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using Outcome = ChildResult::Outcome;

class RunChildTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder / name; }
  ChildCommand shell(const std::string& script) const {
    ChildCommand command;
    command.arguments = {"sh", "-c", script, "sh", folder.path().string()};  // the folder is $1
    command.log_file = file("log");
    return command;
  }
  ChildResult run(const std::string& script) { return run_child(shell(script), never); }
  // Waits until a child has written the file. Returns its first word.
  std::string wait_for_word(const std::string& name) {
    testing::happens([&] { return std::filesystem::exists(file(name)); });
    std::string word;
    std::ifstream(file(name)) >> word;
    return word;
  }
  // Cancels when the child has made the file "started".
  ChildResult run_and_cancel(const ChildCommand& command) {
    std::atomic<bool> cancel = false;
    std::thread other([&] {
      wait_for_word("started");
      cancel = true;
    });
    const ChildResult result = run_child(command, cancel);
    other.join();
    return result;
  }

  const testing::TemporaryFolder folder;
  const std::atomic<bool> never = false;
};

TEST_F(RunChildTest, TheExitCodeIsTold) {
  EXPECT_TRUE(run("exit 0").ok());
  const ChildResult result = run("exit 42");
  EXPECT_FALSE(result.ok());
  EXPECT_EQ(result.outcome, Outcome::kExited);
  EXPECT_EQ(result.exit_code, 42);
  EXPECT_EQ(result.describe(), "ended with exit code 42");
}

TEST_F(RunChildTest, ADeathBySignalIsTold) {
  const ChildResult result = run("kill -9 $$");
  EXPECT_EQ(result.outcome, Outcome::kSignalled);
  EXPECT_EQ(result.signal, SIGKILL);
  EXPECT_EQ(result.describe(), "killed by signal 9 (Killed)");
}

TEST_F(RunChildTest, ItIsStoppedAtItsTimeLimit) {
  ChildCommand command = shell("sleep 60");
  command.time_limit_s = 0.2;
  const ChildResult result = run_child(command, never);
  EXPECT_EQ(result.outcome, Outcome::kTimedOut);
  EXPECT_GE(result.wall_s, 0.2);
  EXPECT_THAT(result.describe(), HasSubstr("time limit"));
}

TEST_F(RunChildTest, ItIsStoppedWhenItDoesNothing) {
  ChildCommand command = shell("sleep 60");
  command.idle_limit_s = 0.2;
  const ChildResult idle = run_child(command, never);
  EXPECT_EQ(idle.outcome, Outcome::kTimedOut);
  EXPECT_TRUE(idle.was_idle);
  EXPECT_THAT(idle.describe(), HasSubstr("it did nothing"));
  // A child that uses CPU time is not idle, even if its limit of CPU time ends it.
  command = shell("while :; do :; done");
  command.idle_limit_s = 30;
  command.cpu_limit_s = 0.2;
  EXPECT_FALSE(run_child(command, never).was_idle);
}

TEST_F(RunChildTest, ItIsStoppedAtItsLimitOfCpuTime) {
  ChildCommand command = shell("while :; do :; done");
  command.cpu_limit_s = 0.2;
  const ChildResult busy = run_child(command, never);
  EXPECT_EQ(busy.outcome, Outcome::kTimedOut);
  EXPECT_GE(busy.cpu_s, 0.2);
  EXPECT_THAT(busy.describe(), HasSubstr("of CPU time"));
  // Sleeping uses no CPU time.
  command = shell("sleep 0.5");
  command.cpu_limit_s = 0.2;
  EXPECT_EQ(run_child(command, never).outcome, Outcome::kExited);
}

TEST_F(RunChildTest, AnotherThreadCancelsIt) {
  const ChildResult result = run_and_cancel(shell("touch $1/started; sleep 600"));
  EXPECT_EQ(result.outcome, Outcome::kCancelled);
  EXPECT_EQ(result.describe(), "cancelled");
}

TEST_F(RunChildTest, WhatIgnoresTheRequestIsKilled) {
  EXPECT_EQ(run_and_cancel(shell("trap '' TERM; touch $1/started; while :; do sleep 600; done")).outcome,
            Outcome::kCancelled);
}

TEST_F(RunChildTest, WhatIsCancelledBeforehandIsNotStarted) {
  EXPECT_EQ(run_child(shell("touch $1/started"), std::atomic<bool>(true)).outcome, Outcome::kCancelled);
  EXPECT_FALSE(std::filesystem::exists(file("started")));
}

TEST_F(RunChildTest, ItsChildrenAreStoppedWithIt) {
  EXPECT_EQ(run_and_cancel(shell("sleep 600 & echo $! > $1/new; mv $1/new $1/started; wait")).outcome,
            Outcome::kCancelled);
  const std::string pid = wait_for_word("started");
  EXPECT_TRUE(testing::ends(std::stoi(pid))) << pid;
}

TEST_F(RunChildTest, ItsChildrenDoNotOutliveIt) {
  EXPECT_TRUE(run("sleep 600 & echo $! > $1/pid").ok());
  const std::string pid = wait_for_word("pid");
  EXPECT_TRUE(testing::ends(std::stoi(pid))) << pid;
}

TEST_F(RunChildTest, ItDiesWithUs) {
  const pid_t us = fork();
  if (us == 0) {
    run("echo $$ > $1/new; mv $1/new $1/pid; exec sleep 600");
    _exit(0);
  }
  const std::string pid = wait_for_word("pid");
  kill(us, SIGKILL);
  waitpid(us, nullptr, 0);
  EXPECT_TRUE(testing::ends(std::stoi(pid))) << pid;
}

TEST_F(RunChildTest, WhatCannotBeStartedSaysWhy) {
  ChildCommand command;
  EXPECT_EQ(run_child(command, never).outcome, Outcome::kNotStarted);
  command.arguments = {"rumi-no-such-program"};
  EXPECT_THAT(run_child(command, never).describe(), HasSubstr("rumi-no-such-program: not found in PATH"));
  command.arguments = {file("nothing")};
  EXPECT_THAT(run_child(command, never).describe(), HasSubstr("nothing: cannot be executed: No such file"));
  std::ofstream(file("text")) << "words";
  command.arguments = {file("text")};
  const ChildResult result = run_child(command, never);
  EXPECT_EQ(result.outcome, Outcome::kNotStarted);
  EXPECT_THAT(result.describe(), HasSubstr("text: cannot be executed: Permission denied"));
}

TEST_F(RunChildTest, WithoutItsLogItIsNotStarted) {
  ChildCommand command = shell("touch $1/started");
  command.log_file = file("no/such/folder/log");
  const ChildResult result = run_child(command, never);
  EXPECT_EQ(result.outcome, Outcome::kNotStarted);
  EXPECT_THAT(result.describe(), HasSubstr("no/such/folder/log: No such file"));
  EXPECT_FALSE(std::filesystem::exists(file("started")));
}

TEST_F(RunChildTest, BothOutputsAreAppendedToTheLog) {
  EXPECT_EQ(run("echo one; echo two >&2").last_output, "one\ntwo\n");
  run("echo three");
  EXPECT_EQ(testing::read_file(file("log")), "one\ntwo\nthree\n");
}

TEST_F(RunChildTest, TheLogIsBoundedAndTheEndIsKept) {
  ChildCommand command = shell("head -c 5000000 /dev/zero; echo last words");
  command.log_limit_bytes = 1000;
  const ChildResult result = run_child(command, never);
  EXPECT_TRUE(result.ok());
  EXPECT_THAT(testing::read_file(file("log")), HasSubstr("size limit"));
  EXPECT_LT(std::filesystem::file_size(file("log")), 1200U);
  EXPECT_EQ(result.last_output.size(), 16384U);
  EXPECT_THAT(result.last_output, EndsWith("last words\n"));
}

TEST_F(RunChildTest, AFullDiskDoesNotStopIt) {
  if (access("/dev/full", W_OK) != 0) GTEST_SKIP() << "SKIPPED: no /dev/full here";
  ChildCommand command = shell("echo words");
  command.log_file = "/dev/full";
  const ChildResult result = run_child(command, never);
  EXPECT_TRUE(result.ok());
  EXPECT_EQ(result.last_output, "words\n");
}

TEST_F(RunChildTest, ItNeedsNeitherLogNorOutput) {
  ChildCommand command = shell("exec >&- 2>&-; exit 3");
  command.log_file.clear();
  EXPECT_EQ(run_child(command, never).exit_code, 3);
}

TEST_F(RunChildTest, ItRunsAtItsNiceness) {
  ChildCommand command = shell("nice");
  command.nice = 19;
  EXPECT_EQ(run_child(command, never).last_output, "19\n");
}

TEST_F(RunChildTest, ItsEnvironmentSaysHowManyThreads) {
  ASSERT_EQ(setenv("RUMI_OURS", "kept", 1), 0);
  ASSERT_EQ(setenv("OMP_NUM_THREADS", "64", 1), 0);
  ChildCommand command = shell("echo $OMP_NUM_THREADS $OPENBLAS_NUM_THREADS $RUMI_OURS $RUMI_ITS");
  command.threads = 3;
  command.environment = {"RUMI_ITS=added"};
  EXPECT_EQ(run_child(command, never).last_output, "3 3 kept added\n");
  unsetenv("RUMI_OURS");
  unsetenv("OMP_NUM_THREADS");
}

TEST_F(RunChildTest, OurDescriptorsStayOurs) {
  // The descriptor is not close-on-exec: children would inherit it, as they would LCM's sockets.
  const int ours = fcntl(STDERR_FILENO, F_DUPFD, 100);
  ASSERT_GE(ours, 100);
  const std::string probe = "test -e /proc/$$/fd/" + std::to_string(ours);
  ASSERT_EQ(system(("sh -c '" + probe + "'").c_str()), 0);
  EXPECT_EQ(run(probe).exit_code, 1);
  close(ours);
}

TEST_F(RunChildTest, ThreadsDoNotMixUpTheirChildren) {
  std::vector<std::thread> threads;
  std::atomic<int> right = 0;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 10; ++i) {
        const std::string number = std::to_string(10 * t + i);
        const ChildResult result = run("echo " + number + "; exit " + number);
        if (result.last_output == number + "\n" && result.exit_code == 10 * t + i) ++right;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, 40);
}

TEST_F(RunChildTest, WhatItSaysIsHandedOnAsItComes) {
  ChildCommand command = shell("echo one; head -c 100000 /dev/zero; echo two");
  std::string said;
  command.on_output = [&](std::string_view text) { said += text; };
  EXPECT_TRUE(run_child(command, never).ok());
  EXPECT_EQ(said, "one\n" + std::string(100000, '\0') + "two\n");
}

TEST_F(RunChildTest, ItsInputIsEmpty) { EXPECT_TRUE(run("cat; cat").ok()); }

TEST_F(RunChildTest, ItDoesNotIgnoreWhatWeIgnore) {
  const auto before = signal(SIGPIPE, SIG_IGN);
  const ChildResult result = run("kill -PIPE $$; echo survived");
  signal(SIGPIPE, before);
  EXPECT_EQ(result.outcome, Outcome::kSignalled);
  EXPECT_EQ(result.signal, SIGPIPE);
}

TEST_F(RunChildTest, CpuTimeIsCounted) {
  EXPECT_GT(run("i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done").cpu_s, 0.005);
  EXPECT_GT(run("(i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done) & wait").cpu_s, 0.005);  // the time of its
                                                                                              // children
}

}  // namespace
}  // namespace rumi::ruminator
