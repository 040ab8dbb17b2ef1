// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/supervisor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "tests/support/process_state.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

using std::chrono::milliseconds;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

Supervised shell(const std::string& name, const std::string& script) {
  return {name, {"/bin/sh", "-c", script}, false, 0};
}

SupervisorOptions quick() {
  SupervisorOptions options;
  options.source_delay = milliseconds(0);
  options.restart_delay = milliseconds(20);
  options.failed_start = milliseconds(0);  // no death counts as a failed start
  options.settle = milliseconds(50);
  options.stop_idle = milliseconds(1000);
  options.stop_limit = milliseconds(20'000);
  return options;
}

class SupervisorTest : public ::testing::Test {
 protected:
  // Runs until the end. The output "stop" or "at once" of a process sets stop_ or at_once_.
  std::string run(std::vector<Supervised> children, const SupervisorOptions& options = quick(),
                  const std::function<void()>& before_last_stage = {}) {
    Supervisor supervisor(std::move(children), options, [this](const std::string& name, const std::string& line) {
      lines_.emplace_back(name, line);
      if (line == "stop") stop_ = true;
      if (line == "at once") at_once_ = true;
    });
    std::string reason =
        supervisor.run(stop_, at_once_, {[this] { before_stop_ = true; }, before_last_stage, {}}).error_text();
    restarts_ = supervisor.restarts();
    not_all_ = supervisor.not_all();
    return reason;
  }
  const testing::TemporaryFolder folder_;
  std::atomic<bool> stop_ = false, at_once_ = false;
  std::vector<std::pair<std::string, std::string>> lines_;
  int restarts_ = 0;
  bool before_stop_ = false, not_all_ = false;
};

TEST_F(SupervisorTest, EndsWithItsSourceAndNamesEveryLine) {
  Supervised source = shell("camera", "echo one; echo two >&2; printf three");
  source.source = true;
  EXPECT_EQ(run({source, shell("server", "trap 'echo bye; exit 0' TERM; while :; do sleep 0.05; done")}), "");
  EXPECT_THAT(lines_, Contains(Pair("camera", "one")));
  EXPECT_THAT(lines_, Contains(Pair("camera", "two")));
  EXPECT_THAT(lines_, Contains(Pair("camera", "three"))) << "a last line without an end";
  EXPECT_THAT(lines_, Contains(Pair("server", "bye"))) << "it was asked to end, not killed";
  EXPECT_EQ(restarts_, 0);
  EXPECT_TRUE(before_stop_);
}

TEST_F(SupervisorTest, RemembersThatTheSourceDidNotGiveAll) {
  Supervised source = shell("camera", "exit 3");
  source.source = true;
  EXPECT_EQ(run({source}), "");
  EXPECT_TRUE(not_all_);
  EXPECT_EQ(restarts_, 0);
  source.command.back() = "exit 0";
  EXPECT_EQ(run({source}), "");
  EXPECT_FALSE(not_all_);
}

TEST_F(SupervisorTest, KeepsWhatThoseWhoDidNotGiveAllSaidLast) {
  Supervised source = shell("camera",
                            "echo '10:15:00 camera error early'; echo fine; "
                            "echo '10:15:00.123 camera error 2 of 5 left out'; exit 3");
  source.source = true;
  Supervised server = shell("server",
                            "trap 'echo \"10:15:01.000 server error no pose\" >&2; exit 3' TERM; while :; do "
                            "sleep 0.05; done");
  Supervisor supervisor({source, server}, quick(), [](const std::string&, const std::string&) {});
  EXPECT_EQ(supervisor.run(stop_, at_once_, {}).error_text(), "");
  EXPECT_THAT(supervisor.complaints(), ::testing::ElementsAre("camera: 2 of 5 left out", "server: no pose"));
}

TEST_F(SupervisorTest, ASourceThatItEndsItselfHasGivenAllThatWasWanted) {
  Supervised source = shell("camera",
                            "trap 'echo \"10:15:01.000 camera error ended\"; exit 3' TERM; echo stop; while :; "
                            "do sleep 0.05; done");
  source.source = true;
  EXPECT_EQ(run({source}), "");
  EXPECT_FALSE(not_all_);
}

TEST_F(SupervisorTest, AsksThoseWhoCanToReadTheirOptionsAgain) {
  const std::string script = "trap 'echo read; echo stop' USR2; echo ready; while :; do sleep 0.05; done";
  Supervised camera = shell("camera", script), other = shell("other", script);
  camera.reloads = true;
  bool ready = false;
  Supervisor supervisor({camera, other}, quick(), [&](const std::string& name, const std::string& line) {
    lines_.emplace_back(name, line);
    ready |= name == "camera" && line == "ready";
    if (line == "stop") stop_ = true;
  });
  Supervisor::Hooks hooks;
  hooks.reload = [&ready] { return std::exchange(ready, false); };
  EXPECT_EQ(supervisor.run(stop_, at_once_, hooks).error_text(), "");
  EXPECT_THAT(lines_, Contains(Pair("camera", "read")));
  EXPECT_THAT(lines_, Not(Contains(Pair("other", "read"))));
}

TEST_F(SupervisorTest, StartsItsSourceLast) {
  SupervisorOptions options = quick();
  options.source_delay = milliseconds(300);
  Supervised source = shell("camera", "echo image");
  source.source = true;
  EXPECT_EQ(run({source, shell("server", "echo ready; sleep 10")}, options), "");
  ASSERT_GE(lines_.size(), 2u);
  EXPECT_EQ(lines_[0].second, "ready");
  EXPECT_EQ(lines_[1].second, "image");
  EXPECT_EQ(restarts_, 0);
}

TEST_F(SupervisorTest, StartsWhatDiesAgain) {
  const std::string counter = folder_ / "counter";
  // It is killed by a signal twice, then it works.
  const std::string script =
      "echo x >> " + counter + "; [ $(wc -l < " + counter + ") -gt 2 ] || kill -9 $$; echo stop; sleep 10";
  EXPECT_EQ(run({shell("server", script)}), "");
  EXPECT_EQ(restarts_, 2);
  EXPECT_THAT(lines_, Contains(Pair("rumi", HasSubstr("signal 9"))));
}

TEST_F(SupervisorTest, WhatHasRunForLongIsStartedAgainAtOnce) {
  SupervisorOptions options = quick();
  options.restart_delay = milliseconds(20'000);
  options.restart_delay_max = milliseconds(100);
  const std::string mark = folder_ / "mark";
  const std::string script =
      "[ ! -e " + mark + " ] || { echo stop; sleep 10; }; touch " + mark + "; sleep 0.3; kill -9 $$";
  EXPECT_EQ(run({shell("server", script)}, options), "");
  EXPECT_EQ(restarts_, 1);
  EXPECT_THAT(lines_, Contains(Pair("rumi", HasSubstr("starting it again at once")))) << "images are lost meanwhile";
}

TEST_F(SupervisorTest, GivesUpOnWhatNeverStarts) {
  SupervisorOptions options = quick();
  options.failed_start = milliseconds(60'000);
  EXPECT_THAT(run({shell("server", "echo no luck; exit 1"), shell("other", "sleep 1000")}, options),
              HasSubstr("server ended with exit code 1, 3 times in a row"));
}

TEST_F(SupervisorTest, GivesUpAtOnceWhereStartingAgainWouldNotHelp) {
  EXPECT_THAT(run({shell("server", "exit 2")}), HasSubstr("starting it again would not help"));
  EXPECT_FALSE(before_stop_) << "there is nobody to ask";
  EXPECT_EQ(restarts_, 0);
}

TEST_F(SupervisorTest, WhatWouldFailAgainIsNotStartedAgainAndItsWordsAreTheReason) {
  Supervised source = shell("camera", "echo hello; echo '10:15:00.123 camera error a.mp4: is no video' >&2; exit 1");
  source.source = source.fails_once = true;
  EXPECT_EQ(run({source, shell("server", "sleep 10")}), "camera: a.mp4: is no video");
  EXPECT_EQ(restarts_, 0);
  source.command.back() = "exit 1";
  EXPECT_EQ(run({source}), "camera ended with exit code 1");
}

TEST_F(SupervisorTest, SaysThatAnExecutableIsMissing) {
  EXPECT_EQ(run({{"server", {"/no/such/file"}, false, 0}}),
            "server cannot be started: /no/such/file: cannot be executed: No such file or directory");
}

TEST_F(SupervisorTest, StopsInStagesWithWordInBetween) {
  Supervised first =
      shell("front", "trap 'sleep 0.2; echo front done; exit 0' TERM; echo stop; while :; do sleep 0.05; done");
  Supervised last = shell("map", "trap 'echo map done; exit 0' TERM; while :; do sleep 0.05; done");
  last.stop_stage = 1;
  EXPECT_EQ(run({last, first}, quick(), [this] { lines_.emplace_back("test", "asked"); }), "");
  std::vector<std::string> order;
  for (const auto& [name, line] : lines_) {
    if (line != "stop") order.push_back(line);
  }
  EXPECT_EQ(order, (std::vector<std::string>{"front done", "asked", "map done"}));
}

// The empty trap ignores further requests: a shell that is asked again while it answers would begin its answer anew.
Supervised finisher(const std::string& on_request) {
  Supervised child =
      shell("worker", "trap 'trap \"\" USR1; " + on_request + "' USR1; trap 'echo stopped; exit 0' TERM; " +
                          "echo works; while :; do sleep 0.02; done");
  child.finishes = true;
  return child;
}

TEST_F(SupervisorTest, WaitsForWhoHasWorkLeftWhenTheSourceEnds) {
  Supervised source = shell("camera", "sleep 0.3");
  source.source = true;
  const Supervised server = shell("server", "trap 'echo server stopped; exit 0' TERM; while :; do sleep 0.02; done");
  EXPECT_EQ(run({server, finisher("sleep 0.5; echo finished; exit 0"), source}), "");
  std::vector<std::string> order;
  for (const auto& [name, line] : lines_) order.push_back(line);
  EXPECT_EQ(order, (std::vector<std::string>{"works", "finished", "server stopped"}));
  EXPECT_EQ(restarts_, 0);
}

TEST_F(SupervisorTest, WhoDiesOverItsLastWorkIsStartedAndAskedAgain) {
  const std::string mark = folder_ / "mark";
  Supervised source = shell("camera", "sleep 0.3");
  source.source = true;
  const std::string dies_first =
      "if [ -e " + mark + " ]; then echo finished; exit 0; else touch " + mark + "; kill -9 $$; fi";
  EXPECT_EQ(run({finisher(dies_first), source}), "");
  EXPECT_EQ(restarts_, 1);
  EXPECT_EQ(lines_.back().second, "finished");
}

TEST_F(SupervisorTest, StoppedItWaitsForNobodysWork) {
  Supervised source = shell("camera", "sleep 0.3");
  source.source = true;
  EXPECT_EQ(run({finisher("echo stop"), source}), "");
  EXPECT_THAT(lines_, Contains(Pair("worker", "stopped")));
  lines_.clear();
  stop_ = false;
  EXPECT_EQ(run({finisher("echo finished; exit 0"), shell("other", "sleep 0.3; echo stop; sleep 10")}), "");
  EXPECT_THAT(lines_, Not(Contains(Pair("worker", "finished")))) << "Ctrl-C: nobody is to finish anything";
}

TEST_F(SupervisorTest, TheSourceIsStoppedBeforeTheOthersAreAsked) {
  Supervised source = shell("camera", "trap 'echo camera done; exit 0' TERM; echo stop; while :; do sleep 0.05; done");
  source.source = true;
  Supervisor supervisor({source, shell("server", "trap 'echo server done; exit 0' TERM; while :; do sleep 0.05; done")},
                        quick(), [&](const std::string&, const std::string& line) {
                          lines_.emplace_back("", line);
                          if (line == "stop") stop_ = true;
                        });
  Supervisor::Hooks hooks;
  hooks.before_stop = [&] { lines_.emplace_back("", "asked"); };
  EXPECT_EQ(supervisor.run(stop_, at_once_, hooks).error_text(), "");
  std::vector<std::string> order;
  for (const auto& [name, line] : lines_) order.push_back(line);
  EXPECT_EQ(order, (std::vector<std::string>{"stop", "camera done", "asked", "server done"}));
}

// Returns a script that works until it has used so much CPU time, in clock ticks of 10 ms, however long that takes.
std::string at_work(int ticks) {
  const std::string look = "read -r _ _ _ _ _ _ _ _ _ _ _ _ _ u s _ </proc/$$/stat; ";
  return look + "end=$((u + s + " + std::to_string(ticks) + ")); while [ $((u + s)) -lt $end ]; do i=0; " +
         "while [ $i -lt 2000 ]; do i=$((i + 1)); done; " + look + "done; ";
}

TEST_F(SupervisorTest, WhoIsAtWorkIsWaitedFor) {
  SupervisorOptions options = quick();
  options.stop_idle = milliseconds(700);
  const std::string script =
      "trap '" + at_work(100) + " echo done; exit 0' TERM; echo stop; while :; do sleep 0.05; done";
  Supervised last = shell("map", "trap 'echo map done; exit 0' TERM; while :; do sleep 0.05; done");
  last.stop_stage = 1;
  EXPECT_EQ(run({last, shell("slow", script)}, options), "");
  std::vector<std::string> order;
  for (const auto& [name, line] : lines_) order.push_back(line);
  EXPECT_EQ(order, (std::vector<std::string>{"stop", "done", "map done"}));
}

TEST_F(SupervisorTest, WhoWaitsForOneAtWorkIsWaitedForToo) {
  SupervisorOptions options = quick();
  options.stop_idle = milliseconds(700);
  const std::string answers = folder_ / "answers";
  ASSERT_EQ(mkfifo(answers.c_str(), 0600), 0);
  Supervised front = shell("front", "trap 'read -r answer <" + answers +
                                        "; echo $answer; exit 0' TERM; echo stop; while :; do sleep 0.05; done");
  Supervised map = shell(
      "map", "trap 'exit 0' TERM; " + at_work(150) + " echo stored >" + answers + "; while :; do sleep 0.05; done");
  map.stop_stage = 1;
  EXPECT_EQ(run({map, front}, options), "");
  EXPECT_THAT(lines_, Contains(Pair("front", "stored")));
}

TEST_F(SupervisorTest, KillsWhatDoesNotEnd) {
  SupervisorOptions options = quick();
  options.stop_idle = milliseconds(700);
  Supervised last = shell("map", "trap 'echo map done; exit 0' TERM; while :; do sleep 0.05; done");
  last.stop_stage = 1;
  EXPECT_EQ(run({last, shell("deaf", "trap '' TERM; echo stop; while :; do sleep 1; done")}, options), "");
  EXPECT_THAT(lines_, Contains(Pair("rumi", HasSubstr("deaf did not end when asked to: killed, as nothing was done"))));
  EXPECT_THAT(lines_, Contains(Pair("map", "map done"))) << "the others end as ever";
}

TEST_F(SupervisorTest, KillsWhatNeverEnds) {
  SupervisorOptions options = quick();
  options.stop_limit = milliseconds(1500);
  EXPECT_EQ(run({shell("mad", "trap '' TERM; echo stop; while :; do :; done")}, options), "");
  EXPECT_THAT(lines_, Contains(Pair("rumi", HasSubstr("still at work after"))));
}

TEST_F(SupervisorTest, AskedTwiceItWaitsForNobody) {
  SupervisorOptions options = quick();
  options.stop_idle = options.stop_limit = milliseconds(100'000);
  Supervised last = shell("map", "trap '' TERM; while :; do sleep 0.05; done");
  last.stop_stage = 1;
  bool asked = false;
  EXPECT_EQ(run({last, shell("deaf", "trap 'echo at once' TERM; echo stop; while :; do sleep 0.05; done")}, options,
                [&asked] { asked = true; }),
            "");
  EXPECT_FALSE(asked);
  EXPECT_THAT(lines_, Contains(Pair("rumi", HasSubstr("killed, as everything is to end at once"))));
}

// The server writes 300 kB, which is more than a pipe holds.
TEST_F(SupervisorTest, WhatIsSaidBesideAHooksProcessIsReadOn) {
  const auto fifo = [this](const char* name) {
    const std::string file = folder_ / name;
    EXPECT_EQ(mkfifo(file.c_str(), 0600), 0);
    return file;
  };
  const std::string request = fifo("request"), answer = fifo("answer");
  const Supervised server =
      shell("server", "trap 'exit 0' TERM; echo stop; read -r what <" + request +
                          "; i=0; while [ $i -lt 3000 ]; do i=$((i + 1)); echo " + std::string(99, 'x') +
                          "; done; echo written >" + answer + "; while :; do sleep 0.05; done");
  Supervisor supervisor({server}, quick(), [this](const std::string& name, const std::string& line) {
    lines_.emplace_back(name, line);
    if (line == "stop") stop_ = true;
  });
  Supervisor::Hooks hooks;
  std::string error;
  hooks.before_stop = [&] {
    const std::string ask = "echo write >" + request + "; timeout 20 cat " + answer;
    error = supervisor.run_beside(shell("snapshot", ask), at_once_).error_text();
  };
  EXPECT_EQ(supervisor.run(stop_, at_once_, hooks).error_text(), "");
  EXPECT_EQ(error, "");
  EXPECT_THAT(lines_, Contains(Pair("snapshot", "written")));
  EXPECT_EQ(std::count_if(lines_.begin(), lines_.end(), [](const auto& line) { return line.second[0] == 'x'; }), 3000);
  EXPECT_EQ(supervisor.restarts(), 0);
}

// The server dies while another process asks it for something, as map_server may during a snapshot. It is restarted,
// but the source, which was stopped, is not.
TEST_F(SupervisorTest, WhoDiesBesideAHooksProcessIsStartedAgain) {
  const std::string file = folder_ / "beside";
  Supervised camera = shell("camera", "echo camera; echo stop; while :; do sleep 0.05; done");
  camera.source = true;
  const Supervised server = shell("server", "if [ -e " + file + " ]; then echo again >" + file +
                                                ".answer; while :; do sleep 0.05; done; fi; while [ ! -e " + file +
                                                " ]; do sleep 0.02; done; exit 9");
  Supervisor supervisor({server, camera}, quick(), [this](const std::string& name, const std::string& line) {
    lines_.emplace_back(name, line);
    if (line == "stop") stop_ = true;
  });
  Supervisor::Hooks hooks;
  std::string error;
  hooks.before_stop = [&] {
    const std::string ask = "touch " + file + "; i=0; while [ ! -e " + file +
                            ".answer ] && [ $i -lt 400 ]; do i=$((i + 1)); sleep 0.05; done; cat " + file + ".answer";
    error = supervisor.run_beside(shell("snapshot", ask), at_once_).error_text();
  };
  EXPECT_EQ(supervisor.run(stop_, at_once_, hooks).error_text(), "");
  EXPECT_EQ(error, "");
  EXPECT_THAT(lines_, Contains(Pair("snapshot", "again")));
  EXPECT_EQ(supervisor.restarts(), 1);
  EXPECT_EQ(std::count(lines_.begin(), lines_.end(), std::make_pair(std::string("camera"), std::string("camera"))), 1);
}

TEST_F(SupervisorTest, AHooksProcessThatFailsOrIsKilledSaysSo) {
  Supervisor supervisor({shell("server", "echo stop; sleep 100")}, quick(),
                        [this](const std::string&, const std::string& line) {
                          if (line == "stop") stop_ = true;
                          if (line == "at once") at_once_ = true;
                        });
  Supervisor::Hooks hooks;
  std::string failed, missing, killed;
  hooks.before_stop = [&] {
    failed = supervisor.run_beside(shell("snapshot", "exit 4"), at_once_).error_text();
    missing = supervisor.run_beside({"snapshot", {"/no/such/file"}}, at_once_).error_text();
    killed = supervisor.run_beside(shell("snapshot", "trap '' TERM; echo at once; sleep 100"), at_once_).error_text();
  };
  EXPECT_EQ(supervisor.run(stop_, at_once_, hooks).error_text(), "");
  EXPECT_EQ(failed, "snapshot ended with exit code 4");
  EXPECT_THAT(missing, HasSubstr("snapshot cannot be started: /no/such/file"));
  EXPECT_THAT(killed, HasSubstr("snapshot was killed"));
}

TEST_F(SupervisorTest, KillsGrandchildrenToo) {
  const std::string file = folder_ / "grandchild";
  EXPECT_EQ(run({shell("parent", "sleep 1000 & echo $! > " + file + "; echo stop; wait")}), "");
  pid_t grandchild = 0;
  std::ifstream(file) >> grandchild;
  ASSERT_GT(grandchild, 0);
  EXPECT_TRUE(testing::ends(grandchild));
}

TEST_F(SupervisorTest, CutsEndlessLines) {
  Supervised source = shell("noisy", "head -c 100000 /dev/zero | tr '\\0' x");
  source.source = true;
  EXPECT_EQ(run({source}), "");
  size_t total = 0;
  for (const auto& [name, line] : lines_) total += line.size();
  EXPECT_EQ(total, 100000u);
  EXPECT_GT(lines_.size(), 3u);
}

}  // namespace
}  // namespace rumi::tool
