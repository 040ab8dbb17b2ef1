// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/process.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <utility>

#include "base/command_line/command_line.h"
#include "base/or_throw.h"
#include "base/running/due.h"
#include "base/running/failures.h"
#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "base/this_process/cpu_clock.h"
#include "base/this_process/exit_codes.h"
#include "base/this_process/process_name.h"
#include "base/this_process/resident_bytes.h"
#include "base/this_process/standard_output.h"
#include "bus/process/only_one.h"
#include "bus/process/safe_node.h"
#include "bus/transport/lcm_bus.h"
#include "bus/transport/receive_losses.h"
#include "lcmtypes/rumi/process_status_t.hpp"

namespace rumi {
namespace {

constexpr int kMaxDispatchMs = 20;
constexpr std::chrono::seconds kFinishTimeout{5};
constexpr int64_t kStatusPeriodUs = 1'000'000;
constexpr const char* kLossAdvice =
    "the receive buffer is too small for what comes, or the machine too busy; recv_buf_size=8388608 in the LCM URL and "
    "`sudo sysctl -w net.core.rmem_max=8388608` help";
// How long a process that begins waits for answers of those on the bus. It is short, because every start waits for it,
// also one after a crash.
constexpr std::chrono::milliseconds kAnswer{100};

std::atomic<int> g_stop_signals = 0;
std::atomic<int> g_finish_signals = 0;
std::atomic<bool> g_reload = false;
static_assert(std::atomic<int>::is_always_lock_free, "it is used in a signal handler");

extern "C" void on_stop_signal(int signal) {
  // The second signal ends the process at once.
  if (++g_stop_signals > 1) _exit(128 + signal);
}

extern "C" void on_finish_signal(int /*signal*/) { ++g_finish_signals; }
extern "C" void on_reload_signal(int /*signal*/) { g_reload = true; }

void catch_signal(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_flags = SA_RESTART;
  action.sa_handler = handler;
  sigaction(signal, &action, nullptr);
  // The parent process may have blocked the signal until now (ChildLaunch::held_signals).
  sigset_t unblocked;
  sigemptyset(&unblocked);
  sigaddset(&unblocked, signal);
  pthread_sigmask(SIG_UNBLOCK, &unblocked, nullptr);
}

// Called first, because the parent process may send the signal at any time.
void catch_finish_signal() { catch_signal(SIGUSR1, on_finish_signal); }
void catch_reload_signal() { catch_signal(SIGUSR2, on_reload_signal); }
void catch_stop_signals() {
  catch_signal(SIGINT, on_stop_signal);
  catch_signal(SIGTERM, on_stop_signal);
}

struct CommonFlags {
  std::string lcm_url = kDefaultLcmUrl;
  ChannelNames names;
  std::string config;
  std::vector<std::string> settings;
  bool verbose = false, quiet = false;
};

void add_common_flags(CommandLine& app, CommonFlags* flags) {
  app.add_option("-l,--lcm-url", flags->lcm_url, "LCM URL")->envname("LCM_DEFAULT_URL")->show_default();
  app.add_option("--channel-prefix", flags->names.prefix, "put before every channel name (several robots on one bus)");
  app.add_option("-c,--channel", flags->names.camera, "channel of the camera images")->show_default();
  app.add_option("--config", flags->config, "YAML file with options, see below")->type_name("FILE");
  app.add_option("--set", flags->settings, "set one option, may be repeated; wins over --config")
      ->type_name("KEY=VALUE")
      ->one_each();
  app.add_flag("-v,--verbose", flags->verbose, "log more");
  app.add_flag("-q,--quiet", flags->quiet, "log warnings and errors only");
}

// Reads the options of all sources. Returns a message for the user if one cannot be used, else an empty string.
std::string read_options(const CommonFlags& flags, const ProcessDescription& description, OptionTable* table) {
  const std::string problem = load_options(*table, flags.config, flags.settings);
  return problem.empty() && description.check_options ? description.check_options() : problem;
}

// Reads the options again and hands them to the running node. Logs an error if they cannot be used.
void reload(const CommonFlags& flags, OptionTable* table, const ProcessDescription& description, Node& node) {
  table->reset();
  std::string problem = read_options(flags, description, table);
  if (problem.empty()) problem = thrown_by([&] { description.on_reload(node); });
  if (!problem.empty()) log_error("options read again, but not used: {}", problem);
}

// Answers processes that ask who is on the bus. Returns why this process must end, or an empty string.
std::string look_around(OnlyOne& only_one, StatusPublisher& status, SafeNode& node, int64_t now_us) {
  if (only_one.take_question()) status.answer(node, now_us);
  if (const std::string warning = only_one.take_warning(); !warning.empty()) log_warning("{}", warning);
  return only_one.problem();
}

// Asks who is on the bus. Returns why this process must not begin, or an empty string.
std::string ask_around(Bus& bus, OnlyOne& only_one) {
  only_one.ask();
  const auto end = std::chrono::steady_clock::now() + kAnswer;
  while (only_one.problem().empty() && std::chrono::steady_clock::now() < end) bus.dispatch(10);
  return only_one.problem();
}

// Runs the node until it is done or a signal ends it. Returns why it had to end before that, or an empty string.
std::string run_node(Bus& bus, SafeNode& node, StatusPublisher& status, OnlyOne* only_one,
                     const std::function<void()>& on_reload) {
  std::string problem;
  const auto step = [&] {
    const int64_t now_us = bus.now_us();
    const int64_t wait_ms = (node.next_tick_us(now_us) - now_us + 999) / 1000;
    bus.dispatch(static_cast<int>(std::clamp<int64_t>(wait_ms, 0, kMaxDispatchMs)));
    node.tick(bus.now_us());
    if (g_reload.exchange(false)) on_reload();
  };
  const auto run_while = [&](const auto& condition) {
    while (problem.empty() && condition()) {
      step();
      status.tick(node, bus.now_us());
      if (only_one) problem = look_around(*only_one, status, node, bus.now_us());
    }
  };
  run_while([&] { return g_stop_signals == 0 && g_finish_signals == 0 && !node.done(); });
  if (!problem.empty()) return problem;
  bus.dispatch(0);  // handles what arrived before the signal, such as the last images of a camera that ended first
  log_debug("ending");
  if (g_stop_signals == 0) node.finish();
  if (g_finish_signals > 0) run_while([&] { return g_stop_signals == 0 && !node.finished(); });
  if (g_stop_signals > 0) node.stop();
  status.stopping(node, bus.now_us());
  using Clock = std::chrono::steady_clock;
  int64_t handed_on = node.handed_on();
  for (auto deadline = Clock::now() + kFinishTimeout; !node.finished() && Clock::now() < deadline;) {
    step();
    if (std::exchange(handed_on, node.handed_on()) != handed_on) deadline = Clock::now() + kFinishTimeout;
  }
  if (const std::string what = node.waits_for(); !what.empty())
    log_warning("not everything could be handed on before the end: {}", what);
  status.stopping(node, bus.now_us());
  return {};
}

int wrong_command_line(const std::string& name, const std::string& problem) {
  fmt::print(stderr, "{}: {}\n", name, problem);
  return kNotAgain;
}

int refused(const std::string& problem) {
  log_error("{}", problem);
  return kNotAgain;
}

// Logs the node's complaints. Returns the exit code.
int complain(const Node& node) {
  const std::vector<std::string> complaints = node.complaints();
  for (const std::string& complaint : complaints) log_error("{}", complaint);
  return complaints.empty() ? kDone : kNotAll;
}

int run(int argc, char** argv, const ProcessDescription& description) {
  catch_finish_signal();
  if (description.on_reload) catch_reload_signal();
  CommandLine app(description.summary, description.name);
  CommonFlags flags;
  OptionTable table;
  add_common_flags(app, &flags);
  app.set_version(description.about);
  if (description.add_flags) description.add_flags(app, &flags.settings);
  if (description.add_options) description.add_options(table);
  if (const std::string options = table.help(OptionTable::Which::kUsers); !options.empty())
    app.footer("Options for --config and --set, with their defaults (all of them: --help-expert):\n" + options);
  app.add_action(
      "--help-expert", [&table] { fmt::print("{}", table.help(OptionTable::Which::kAll)); },
      "print all options for --config and --set, and exit");

  const CommandLine::Result parsed = app.parse(argc, argv);
  if (parsed.done) return kDone;
  if (!parsed.error.empty())
    return wrong_command_line(description.name,
                              fmt::format("{}\nTry `rumi {} --help`.", parsed.error, description.name));
  if (const std::string problem = read_options(flags, description, &table); !problem.empty())
    return wrong_command_line(description.name, problem);

  start_logging(description.name, flags.verbose, flags.quiet);
  try {
    const ReceiveLosses losses;
    const std::unique_ptr<LcmBus> bus = or_throw(LcmBus::open(flags.lcm_url, flags.names));
    catch_stop_signals();
    std::optional<OnlyOne> only_one;
    if (description.only_one || description.only_one_on_channel) {
      only_one.emplace(*bus, description.name,
                       description.only_one_on_channel ? flags.names.on_wire(channels::kCamera) : "");
      if (const std::string problem = ask_around(*bus, *only_one); !problem.empty()) return refused(problem);
    }
    SafeNode node(description.make_node(*bus), &bus->broken_handlers());
    StatusPublisher status(*bus, description.name, [&losses] { return losses.datagrams(); });
    if (only_one) status.set_claim(only_one->started_us(), only_one->publishes());
    const std::string problem = run_node(*bus, node, status, only_one ? &*only_one : nullptr,
                                         [&] { reload(flags, &table, description, node.node()); });
    return problem.empty() ? complain(node) : refused(problem);
  } catch (const std::exception& e) {
    log_error("{}", reason_of(e));
    return kNotDone;
  }
}

}  // namespace

int run_process(int argc, char** argv, const ProcessDescription& description) {
  std::string problem;
  try {
    const int exit_code = run(argc, argv, description);
    problem = flush_stdout();  // the output of --help, --list and the like
    if (problem.empty()) return exit_code;
  } catch (const std::exception& e) {
    problem = reason_of(e);
  }
  std::fputs(fmt::format("{}: {}\n", description.name, problem).c_str(), stderr);
  return kNotDone;
}

StatusPublisher::StatusPublisher(Bus& bus, std::string process_name, std::function<int64_t()> lost)
    : bus_(bus), name_(std::move(process_name)), count_lost_(std::move(lost)) {}

void StatusPublisher::note_losses(NodeStatus* status) {
  const int64_t lost = count_lost_ ? count_lost_() : 0;
  const int64_t now_lost = lost - std::exchange(lost_, lost);
  if (lost == 0) return;
  status->detail += fmt::format("; {} datagrams lost before they were received", lost);
  if (now_lost == 0) return;
  status->degraded = true;
  status->detail += fmt::format(", {} of them now: {}", now_lost, kLossAdvice);
  if (lost == now_lost)
    log_warning(
        "{} datagrams, and the messages that they are parts of, were lost before they were received: {}; from "
        "now on they are counted in the status",
        lost, kLossAdvice);
}

void StatusPublisher::tick(Node& node, int64_t now_us) {
  if (started_us_ == 0) started_us_ = now_us;
  // If the clock goes back (a log is played again), a new second begins.
  if (!is_due(now_us, last_us_, kStatusPeriodUs)) return;
  publish(node, now_us, process_status_t::RUNNING);
}

void StatusPublisher::set_claim(int64_t started_us, const std::string& publishes) {
  started_us_ = started_us;
  publishes_ = publishes;
}

void StatusPublisher::answer(Node& node, int64_t now_us) { publish(node, now_us, process_status_t::RUNNING); }
void StatusPublisher::stopping(Node& node, int64_t now_us) { publish(node, now_us, process_status_t::STOPPING); }

void StatusPublisher::publish(Node& node, int64_t now_us, int8_t state) {
  NodeStatus node_status = node.status();
  note_losses(&node_status);
  process_status_t message;
  message.utime = now_us;
  message.process = name_;
  message.host = host_name();
  message.pid = getpid();
  message.version = version();
  message.state = state == process_status_t::RUNNING && node_status.degraded ? process_status_t::DEGRADED : state;
  message.detail = node_status.detail;
  message.started_utime = started_us_;
  message.last_utime = node_status.last_utime_us;
  message.messages_in = 0;
  message.messages_out = bus_.published();
  for (const ChannelCounts& counts : bus_.counts()) {
    message.messages_in += counts.received;
    const int64_t refused = counts.channel == channels::kCamera ? node_status.refused_images : 0;
    message.channels.push_back(
        {counts.channel, counts.received, counts.dropped + refused, counts.undecodable, counts.queue_depth});
  }
  if (!publishes_.empty()) message.channels.push_back({publishes_, 0, 0, 0, 0});
  message.nchannels = static_cast<int32_t>(message.channels.size());
  message.processing_ms = static_cast<float>(node_status.processing_ms);
  message.cpu_s = process_cpu_s();
  for (const auto& [stage, cpu_s] : stage_cpu_s(name_)) message.stages.push_back({stage, cpu_s});
  message.nstages = static_cast<int32_t>(message.stages.size());
  message.rss_bytes = resident_bytes();
  bus_.publish(channels::kStatus, message);
  last_us_ = now_us;
}

}  // namespace rumi
