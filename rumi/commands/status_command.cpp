// SPDX-License-Identifier: BSD-3-Clause
// rumi status: shows the state of a running system.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "base/text/json_text.h"
#include "base/this_process/standard_output.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/run/live_status.h"

namespace rumi::tool {
namespace {

struct Arguments : BusFlags {
  bool json = false, follow = false;
};

constexpr std::chrono::milliseconds kListen{2500};  // rates need two statuses of every process
constexpr std::chrono::milliseconds kRefresh{1000};

void listen(Bus& bus, std::chrono::milliseconds duration) {
  const auto end = std::chrono::steady_clock::now() + duration;
  while (std::chrono::steady_clock::now() < end) bus.dispatch(50);
}

void print(const LiveStatus& status, const Arguments& arguments) {
  constexpr const char* kClearScreen = "\x1B[H\x1B[2J";
  if (arguments.follow && !arguments.json && isatty(STDOUT_FILENO)) fmt::print("{}", kClearScreen);
  fmt::print("{}", arguments.json ? json_text(status.to_json(), arguments.follow ? -1 : 2) + "\n" : status.to_text());
  flush_stdout();
}

void tell(const Arguments& arguments) {
  const std::unique_ptr<LcmBus> bus = open_bus(arguments);
  LiveStatus status(*bus);
  listen(*bus, kListen);
  if (status.to_json()["processes"].empty() && !arguments.follow)
    fail_if(
        fmt::format("nothing is heard on {}; is Rumi running, with the same --lcm-url and prefix?", arguments.lcm_url));
  print(status, arguments);
  while (arguments.follow && flush_stdout().empty()) {
    listen(*bus, kRefresh);
    print(status, arguments);
  }
}

}  // namespace

void add_status_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("status", "Show how a live system does: rates, latency, drops, tracking, map");
  add_bus_flags(command, arguments.get());
  command->add_flag("--json", arguments->json, "as JSON");
  command->add_flag("-f,--follow", arguments->follow, "again every second, until Ctrl-C (JSON: a line each time)");
  run_if_chosen(command, chosen, arguments, tell);
}

}  // namespace rumi::tool
