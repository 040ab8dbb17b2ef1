// SPDX-License-Identifier: BSD-3-Clause
// rumi snapshot -o OUT: what a live system has so far, in the same files as `rumi replay` writes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "bus/lcm_bus.h"
#include "bus/process.h"
#include "rumi/commands.h"
#include "rumi/map_file.h"
#include "rumi/output_folder.h"
#include "rumi/run_record.h"
#include "rumi/snapshot.h"

namespace rumi {
namespace {

struct Arguments {
  std::string out, lcm_url = kDefaultLcmUrl;
  ChannelNames names;
  double timeout_s = 10;
};

constexpr double kListenS = 1.5;  // every process tells its status once a second

nlohmann::ordered_json to_json(const process_status_t& status) {
  nlohmann::ordered_json channels = nlohmann::ordered_json::object();
  for (const channel_count_t& channel : status.channels) {
    channels[channel.channel] = {
        {"received", channel.received}, {"dropped", channel.dropped}, {"undecodable", channel.undecodable}};
  }
  return {{"version", status.version}, {"pid", status.pid},
          {"detail", status.detail},   {"running_s", static_cast<double>(status.utime - status.started_utime) * 1e-6},
          {"cpu_s", status.cpu_s},     {"rss_mb", static_cast<double>(status.rss_bytes) / 1e6},
          {"channels", channels}};
}

nlohmann::ordered_json run_record(const Arguments& arguments, const Atlas& atlas, const SnapshotResult& snapshot) {
  nlohmann::ordered_json run{{"finished", true}, {"command", "snapshot"}, {"lcm_url", arguments.lcm_url}};
  run["counts"] = counts_to_json(count(atlas));
  run["processes"] = nlohmann::ordered_json::object();
  nlohmann::ordered_json cpu = nlohmann::ordered_json::object();
  for (const auto& [name, status] : snapshot.processes) {
    run["processes"][name] = to_json(status);
    if (!atlas.frames().empty()) cpu[name] = status.cpu_s * 1e3 / static_cast<double>(atlas.frames().size());
  }
  run["cpu_ms_per_frame"] = cpu;
  return run;
}

void print_processes(const std::map<std::string, process_status_t>& processes) {
  fmt::print("{:<18}{:>10}{:>9}{:>13}{:>8}{:>9}\n", "process", "received", "dropped", "undecodable", "CPU %", "MB");
  for (const auto& [name, status] : processes) {
    int64_t received = 0, dropped = 0, undecodable = 0;
    for (const channel_count_t& channel : status.channels) {
      received += channel.received, dropped += channel.dropped, undecodable += channel.undecodable;
    }
    const double running_s = std::max(1e-3, static_cast<double>(status.utime - status.started_utime) * 1e-6);
    fmt::print("{:<18}{:>10}{:>9}{:>13}{:>8.1f}{:>9.1f}\n", name, received, dropped, undecodable,
               100 * status.cpu_s / running_s, static_cast<double>(status.rss_bytes) / 1e6);
  }
}

std::string take_snapshot(const Arguments& arguments) {
  if (std::string error = prepare_output_folder(arguments.out); !error.empty()) return error;
  std::string error;
  const std::unique_ptr<LcmBus> bus = LcmBus::open(arguments.lcm_url, arguments.names, &error);
  if (!bus) return error;
  const SnapshotResult snapshot = request_snapshot(*bus, arguments.timeout_s, kListenS);
  if (!snapshot.error.empty()) return snapshot.error;
  const Atlas atlas = load_map_bytes(snapshot.database, (std::filesystem::path(arguments.out) / "map.db").string());
  error = write_run_outputs(atlas, arguments.out);
  if (error.empty()) error = write_run_json(arguments.out, run_record(arguments, atlas, snapshot));
  if (error.empty()) {
    print_summary(count(atlas), arguments.out);
    print_processes(snapshot.processes);
  }
  return error;
}

int run(const Arguments& arguments) {
  std::string error;
  try {
    error = take_snapshot(arguments);
  } catch (const std::exception& e) {
    error = e.what();
  }
  if (error.empty()) return 0;
  fmt::print(stderr, "rumi snapshot: {}\n", error);
  return 1;
}

}  // namespace

void add_snapshot_command(CLI::App& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("snapshot", "Write what a live system has so far, as `rumi replay` would");
  command->add_option("-o,--output", arguments->out, "folder: new, empty, or of an earlier run")->required();
  command->add_option("-l,--lcm-url", arguments->lcm_url, "LCM URL")->envname("LCM_DEFAULT_URL")->capture_default_str();
  command->add_option("--channel-prefix", arguments->names.prefix, "before every channel name");
  command->add_option("--timeout", arguments->timeout_s, "wait so long for an answer, s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->callback([arguments, chosen] { *chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace rumi
