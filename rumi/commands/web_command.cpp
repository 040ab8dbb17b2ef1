// SPDX-License-Identifier: BSD-3-Clause
// rumi web: shows a running system in a browser.
#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>

#include "base/running/failures.h"
#include "base/running/log.h"
#include "base/this_process/standard_output.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/run/program_folder.h"
#include "rumi/web/http_server.h"
#include "rumi/web/web_node.h"

namespace rumi::tool {
namespace {

constexpr int kMaxPort = 65535;
constexpr int kWaitMs = 20;  // how long one dispatch waits for messages

struct Arguments : BusFlags {
  int port = 8642;
};

std::atomic<bool> g_stop = false;

void listen_to_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = true; };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

void serve(const Arguments& arguments) {
  if (arguments.port < 0 || arguments.port > kMaxPort)
    refuse_if(fmt::format("--port is {}: must be 1 to {}, or 0 for any that is free", arguments.port, kMaxPort));
  listen_to_signals();
  start_logging("rumi web", false, /*quiet=*/true);
  const std::unique_ptr<LcmBus> bus = open_bus(arguments);
  std::unique_ptr<WebNode> node;
  HttpServer server(arguments.port, [&](const std::string& path) { return node->answer(path); });
  const std::string bus_name =
      arguments.lcm_url + (arguments.names.prefix.empty() ? "" : ", prefix " + arguments.names.prefix);
  node =
      std::make_unique<WebNode>(*bus, PageFiles(page_folder_of(own_folder())), bus_name,
                                [&](const std::string& event, const std::string& data) { server.tell(event, data); });
  fmt::print("http://127.0.0.1:{} shows the system on this bus; Ctrl-C ends it\n", server.port());
  flush_stdout();
  Failures failures("a step");
  while (!g_stop) {
    bus->dispatch(kWaitMs);
    failures.note(thrown_by([&] { node->tick(bus->now_us(), server.listeners() > 0); }), bus->now_us());
    failures.note(thrown_by([&] { server.serve(0); }), bus->now_us());
  }
}

}  // namespace

void add_web_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command =
      app.add_command("web", "Show a live system in a browser: map, camera, tracking, windows, load");
  command->add_option("--port", arguments->port, "of the page, which only this computer can open; 0: any that is free")
      ->show_default();
  add_bus_flags(command, arguments.get());
  command->add_option("-c,--channel", arguments->names.camera, "channel of the camera images")->show_default();
  run_if_chosen(command, chosen, arguments, serve);
}

}  // namespace rumi::tool
