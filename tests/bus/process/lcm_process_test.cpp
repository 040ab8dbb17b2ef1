// SPDX-License-Identifier: BSD-3-Clause
// Tests run_process() as a user meets it: flags, messages, exit codes, signals. Run by tests/run_in_netns.sh.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "base/or_throw.h"
#include "bus/process/process.h"
#include "bus/transport/lcm_bus.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/process_status_t.hpp"
#include "tests/support/patience.h"
#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Clock = std::chrono::steady_clock;

// Runs the test process with its output in a file.
class Child {
 public:
  explicit Child(const std::vector<std::string>& arguments, const char* lcm_default_url = nullptr) {
    std::vector<char*> argv = {const_cast<char*>(TEST_PROCESS)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      if (lcm_default_url)
        setenv("LCM_DEFAULT_URL", lcm_default_url, 1);
      else
        unsetenv("LCM_DEFAULT_URL");
      std::FILE* out = std::freopen(output_file_.c_str(), "w", stdout);
      if (!out || dup2(fileno(stdout), STDERR_FILENO) < 0) _exit(126);
      execv(argv[0], argv.data());
      _exit(127);
    }
  }
  ~Child() {
    if (!ended_) kill(pid_, SIGKILL), wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void signal(int number) const { kill(pid_, number); }
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    ended_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  std::string output() const { return testing::read_file(output_file_); }

 private:
  const testing::TemporaryFolder folder_;
  const std::string output_file_ = folder_ / "output";
  pid_t pid_ = -1;
  bool ended_ = false;
};

// The other side of the bus: sends requests to a child and hears its answers and its status.
class Peer {
 public:
  explicit Peer(const ChannelNames& names = {}) : bus_(or_throw(LcmBus::open(kDefaultLcmUrl, names))) {
    bus_->subscribe<map_request_t>(channels::kTrack, {}, [this](const map_request_t& m) { answer = m.request_id; });
    bus_->subscribe<process_status_t>(channels::kStatus, {}, [this](const process_status_t& m) {
      ++statuses;
      stopping |= m.state == process_status_t::STOPPING;
      if (m.state == process_status_t::DEGRADED) trouble = m.detail;
    });
  }
  void publish_bytes(size_t size) { bus_->publish_raw(channels::kCamera, std::vector<uint8_t>(size)); }
  // Asks until an answer comes, because the child needs time to start. Returns false if none comes.
  bool ask(int id) {
    answer = -1;
    return until([&] { return answer >= 0; }, [&] { request(id); });
  }
  void request(int id) {
    map_request_t message{};
    message.request_id = id;
    bus_->publish(channels::kCamera, message);
  }
  bool until(
      const std::function<bool()>& done, const std::function<void()>& action = [] {}) {
    return testing::happens(done, [&] { action(), bus_->dispatch(50); });
  }
  int answer = -1, statuses = 0;
  bool stopping = false;
  std::string trouble;

 private:
  std::unique_ptr<LcmBus> bus_;
};

TEST(RunProcessTest, HelpShowsEveryFlagAndDefault) {
  Child child({"-h"});
  EXPECT_EQ(child.wait(), 0);
  for (const char* text :
       {"--lcm-url", "--channel-prefix", "--channel TEXT", "--config FILE", "--set KEY=VALUE", "--version",
        "LCM_DEFAULT_URL", "test_process.step = 1", "added to the request id (0 .. 1000)",
        "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152", "--never-finished"})
    EXPECT_THAT(child.output(), HasSubstr(text));
  EXPECT_THAT(child.output(), Not(HasSubstr("test_process.spare")));
  Child expert({"--help-expert"});
  EXPECT_EQ(expert.wait(), 0);
  EXPECT_THAT(expert.output(), AllOf(HasSubstr("test_process.step = 1"), HasSubstr("test_process.spare = 0")));
  // The help shows a default as CLI11 2.1 or 2.4 writes it.
  EXPECT_THAT(child.output(), AnyOf(HasSubstr("--channel TEXT=CAMERA"), HasSubstr("--channel TEXT [CAMERA]")));
}

TEST(RunProcessTest, Version) {
  Child child({"--version"});
  EXPECT_EQ(child.wait(), 0);
  EXPECT_EQ(child.output(), "test_process 1\n");
}

TEST(RunProcessTest, AWrongCommandLineExitsWith2AndSaysWhy) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--nonsense"}, "--nonsense"},
      {{"--nonsense"}, "Try `rumi test_process --help`."},
      {{"--set", "test_process.step=5000"}, "expected a whole number from 0 to 1000"},
      {{"--set", "test_process.stap=5"}, "did you mean test_process.step?"},
      {{"--set", "nonsense"}, "expected KEY=VALUE"},
      {{"--config", "/nowhere.yaml"}, "/nowhere.yaml: cannot be read (No such file or directory)"},
      {{"--set"}, "--set"},
  };
  for (const auto& [arguments, says] : cases) {
    Child child(arguments);
    EXPECT_EQ(child.wait(), 2) << says;
    EXPECT_THAT(child.output(), HasSubstr(says));
    EXPECT_THAT(child.output(), Not(HasSubstr("Usage:"))) << "the reason would scroll away";
  }
}

TEST(RunProcessTest, AnswersAndEndsCleanlyWhenAsked) {
  for (const int number : {SIGINT, SIGTERM}) {
    Peer peer;
    Child child({});
    ASSERT_TRUE(peer.ask(5)) << child.output();
    EXPECT_EQ(peer.answer, 6);
    EXPECT_GE(peer.statuses, 1);
    child.signal(number);
    EXPECT_TRUE(peer.until([&] { return peer.stopping; }));
    EXPECT_EQ(child.wait(), 0) << child.output();
  }
}

TEST(RunProcessTest, WhatHadArrivedWhenItWasAskedToEndIsAnswered) {
  Peer peer;
  Child child({"--slow", "500"});
  ASSERT_TRUE(peer.until([&] { return peer.statuses > 0; })) << child.output();
  peer.request(10);
  ASSERT_TRUE(peer.until([&] { return child.output().find("at work") != std::string::npos; }));
  peer.request(20);
  child.signal(SIGTERM);
  EXPECT_EQ(child.wait(), 0) << child.output();
  EXPECT_TRUE(peer.until([&] { return peer.answer == 21; }));
}

TEST(RunProcessTest, SettingsWinOverTheFileAndDoNotEatTheInput) {
  const testing::TemporaryFolder folder;
  const std::string config = folder.write("config.yaml", "test_process: {step: 100}\n");
  {
    Peer peer;
    Child child({"--config", config, "INPUT"});
    ASSERT_TRUE(peer.ask(0)) << child.output();
    EXPECT_EQ(peer.answer, 100);
  }
  Peer peer;
  Child child({"--set", "test_process.step=7", "--set", "test_process.step=8", "INPUT", "--config", config});
  ASSERT_TRUE(peer.ask(0)) << child.output();
  EXPECT_EQ(peer.answer, 8);
}

TEST(RunProcessTest, OptionsAreReadAgainOnRequestAndBadOnesAreNotUsed) {
  const testing::TemporaryFolder folder;
  const auto write = [&folder](const std::string& text) { return folder.write("config.yaml", text); };
  const std::string config = write("test_process: {step: 100}\n");
  Peer peer;
  Child child({"--config", config});
  ASSERT_TRUE(peer.ask(0)) << child.output();
  const auto asked_until = [&](int answer) { return peer.until([&] { return peer.ask(0) && peer.answer == answer; }); };
  write("test_process: {step: 200}\n");
  child.signal(SIGUSR2);
  EXPECT_TRUE(asked_until(200));
  const auto said_until = [&](const std::string& text) {
    return peer.until([&] { return child.output().find(text) != std::string::npos; });
  };
  write("test_process: {step: 5000}\n");
  child.signal(SIGUSR2);
  EXPECT_TRUE(said_until("expected a whole number from 0 to 1000"));
  write("test_process: {step: 13}\n");
  child.signal(SIGUSR2);
  EXPECT_TRUE(said_until("step is 13: unlucky"));
  EXPECT_TRUE(asked_until(200));
  write("{}\n");  // an option that the file no longer names has its default again
  child.signal(SIGUSR2);
  EXPECT_TRUE(asked_until(1));
}

TEST(RunProcessTest, PrefixAndCameraChannel) {
  Peer peer({"robot1/", "LEFT"});
  Child child({"--channel-prefix", "robot1/", "-c", "LEFT"});
  EXPECT_TRUE(peer.ask(1)) << child.output();
}

TEST(RunProcessTest, SaysThatItsReceiveBufferWasFull) {
  constexpr int kMessages = 300, kBytes = 300'000;  // bytes; together more than any receive buffer that it could have
  Peer peer;
  Child child({});
  ASSERT_TRUE(peer.ask(1)) << child.output();
  child.signal(SIGSTOP);
  for (int i = 0; i < kMessages; ++i) peer.publish_bytes(kBytes);
  child.signal(SIGCONT);
  EXPECT_TRUE(peer.until([&] { return !peer.trouble.empty(); }));
  EXPECT_THAT(peer.trouble, ::testing::ContainsRegex("[0-9]+ datagrams lost before they were received"));
  EXPECT_THAT(child.output(), HasSubstr("sudo sysctl -w net.core.rmem_max="));
}

// The socket is like one of a procman deputy, which is on LCM too, and whose children inherit its sockets.
TEST(RunProcessTest, WhatAnInheritedSocketLosesIsNotItsLoss) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  ASSERT_EQ(bind(socket, reinterpret_cast<sockaddr*>(&address), length), 0);
  ASSERT_EQ(getsockname(socket, reinterpret_cast<sockaddr*>(&address), &length), 0);
  const std::vector<uint8_t> data(60'000);
  for (int i = 0; i < 100; ++i)  // nobody reads them, so they are lost
    sendto(socket, data.data(), data.size(), 0, reinterpret_cast<sockaddr*>(&address), length);
  Peer peer;
  Child child({});
  ASSERT_TRUE(peer.ask(1)) << child.output();
  EXPECT_TRUE(peer.until([&] { return peer.statuses >= 3; }));
  EXPECT_EQ(peer.trouble, "");
  close(socket);
}

TEST(RunProcessTest, EndsByItselfWhenTheNodeIsDone) {
  Peer peer;
  Child child({"--end-after", "1"});
  EXPECT_TRUE(peer.ask(1));
  EXPECT_EQ(child.wait(), 0);
}

// The five seconds begin anew whenever the node hands something on: see below.
TEST(RunProcessTest, ANodeThatDoesNotFinishGoesOnForFiveSecondsAndEnds) {
  Peer peer;
  Child child({"--never-finished"});
  ASSERT_TRUE(peer.ask(1));
  const auto start = Clock::now();
  child.signal(SIGTERM);
  ASSERT_TRUE(peer.until([&] { return peer.stopping; }));
  EXPECT_TRUE(peer.ask(2)) << "it still listens to who may take what it has";
  EXPECT_EQ(child.wait(), 0);
  RecordProperty("seconds", std::to_string(std::chrono::duration<double>(Clock::now() - start).count()));
  EXPECT_THAT(child.output(), HasSubstr("not everything could be handed on before the end: nobody took it"));
}

TEST(RunProcessTest, ANodeThatGetsOnIsGivenTheTimeThatItTakes) {
  Peer peer;
  Child child({"--hands-on-for", "6.5"});
  ASSERT_TRUE(peer.ask(1));
  child.signal(SIGTERM);
  EXPECT_EQ(child.wait(), 0);
  EXPECT_THAT(child.output(), ::testing::Not(HasSubstr("not everything could be handed on")));
}

TEST(RunProcessTest, TheSecondSignalEndsItAtOnce) {
  Peer peer;
  Child child({"--never-finished"});
  ASSERT_TRUE(peer.ask(1));
  child.signal(SIGINT);
  ASSERT_TRUE(peer.until([&] { return peer.stopping; }));
  child.signal(SIGINT);
  EXPECT_EQ(child.wait(), 128 + SIGINT);
  EXPECT_THAT(child.output(), Not(HasSubstr("not everything could be handed on"))) << "as it says when it waited";
}

TEST(RunProcessTest, WhatCannotStartSaysWhyAndExitsWith1) {
  Child child({"--fail"});
  EXPECT_EQ(child.wait(), 1);
  EXPECT_THAT(child.output(), HasSubstr("test_process error no such camera"));
}

TEST(RunProcessTest, WithoutAMulticastRouteItNamesTheTwoCommands) {
  Child by_flag({"-l", "udpm://239.255.76.70:7667?ttl=0"}, "udpm://239.255.76.71:7667");
  EXPECT_EQ(by_flag.wait(), 1);
  EXPECT_THAT(by_flag.output(), HasSubstr("sudo ip link set lo multicast on"));
  EXPECT_THAT(by_flag.output(), HasSubstr("sudo ip route add 239.255.76.70/32 dev lo"));
  Child by_environment({}, "udpm://239.255.76.71:7667");
  EXPECT_EQ(by_environment.wait(), 1);
  EXPECT_THAT(by_environment.output(), HasSubstr("sudo ip route add 239.255.76.71/32 dev lo"));
}

}  // namespace
}  // namespace rumi
