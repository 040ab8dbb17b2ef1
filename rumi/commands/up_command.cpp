// SPDX-License-Identifier: BSD-3-Clause
// rumi up CONFIG: starts, watches and stops the five processes of a live system, which communicate by LCM.
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/running/log.h"
#include "base/this_process/exit_codes.h"
#include "camera_driver/flags.h"
#include "map_server/store/map_store.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/commands/up_arguments.h"
#include "rumi/commands/up_processes.h"
#include "rumi/outputs/masks.h"
#include "rumi/outputs/output_folder.h"
#include "rumi/outputs/reserved_space.h"
#include "rumi/run/map_before.h"
#include "rumi/run/other_system.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kListen{500};  // time in which another system must answer

std::string default_url() {
  const char* variable = std::getenv("LCM_DEFAULT_URL");
  return variable && *variable ? variable : kDefaultLcmUrl;
}

std::atomic<bool> g_stop = false, g_at_once = false, g_reload = false;

void listen_to_signals() {
  struct sigaction action {};
  // A second Ctrl-C ends everything at once.
  action.sa_handler = [](int) {
    if (g_stop.exchange(true)) g_at_once = true;
  };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A closed terminal may send two SIGHUP, one by the kernel and one by the shell. The second one must not end
  // everything at once.
  action.sa_handler = [](int) { g_stop = true; };
  sigaction(SIGHUP, &action, nullptr);
  action.sa_handler = [](int) { g_reload = true; };
  sigaction(SIGUSR2, &action, nullptr);
}

// Unlike fmt::print, fputs does not throw if the terminal was closed.
void say(const std::string& name, const std::string& line) {
  std::fputs(fmt::format("{:>16}| {}\n", name, line).c_str(), stderr);
}

// Tells the user whether the map goes on, and sets it aside for --fresh. Throws std::runtime_error if the map cannot be
// used.
void tell_of_map(const AllOptions& options, bool fresh) {
  const std::string& database = options.map_server.database;
  if (options.map_server.localize_only && !is_file(database))
    throw std::runtime_error("map_server.localize_only needs a map: name its file with map_server.database");
  if (!is_file(database)) return;
  const std::string before = fresh ? "" : value_or_fail(describe_map_before(database));
  if (options.map_server.localize_only && !fs::exists(database))
    throw std::runtime_error(fmt::format("{}: there is no such file to localize in (map_server.database)", database));
  if (options.map_server.localize_only && before.empty())
    throw std::runtime_error(
        fmt::format("{}: there is no map in it to localize in (map_server.localize_only)", database));
  if (options.map_server.localize_only) {
    say("rumi", fmt::format("map: {}, {}, stays as it is", database, before));
  } else if (fresh) {
    const std::string aside = value_or_fail(set_aside(database, options.ruminator.spool));
    say("rumi", fmt::format("map: {}, a new one{}", database,
                            aside.empty() ? "" : fmt::format("; that of before is {} now", aside)));
  } else if (!before.empty()) {
    say("rumi", fmt::format("map: {} goes on, {}; --fresh begins anew", database, before));
  } else {
    say("rumi", fmt::format("map: {}, a new one", database));
  }
}

// An Error if the map is in use, the bus cannot be opened, or another system is on it. Such a system must not even
// start: it would disturb others before it ends.
Result<> check_place(const AllOptions& options) {
  const UpOptions& up = options.up;
  const std::string& database = options.map_server.database;
  if (is_file(database) && !options.map_server.localize_only)
    if (const auto free = map_server::DatabaseLock::take(database); !free) return free.error();
  ChannelNames names;
  names.prefix = up.channel_prefix;
  names.camera = up.channel;
  const Result<std::unique_ptr<LcmBus>> bus = LcmBus::open(up.lcm_url.empty() ? default_url() : up.lcm_url, names);
  if (!bus) return bus.error();
  const std::string camera_channel = up.input.empty() ? "" : names.on_wire(channels::kCamera);
  return find_other_system(**bus, {{"map_server", "ruminator", "front_tracker"}, camera_channel}, kListen);
}

// Warns if the disk has no room for 1000 images. The length of a live run is unknown.
void warn_of_little_space(const std::string& database) {
  constexpr int64_t kImages = 1000;
  const fs::path folder = fs::absolute(database).parent_path();
  if (const std::string doubt = doubt_about_space(folder.string(), kImages); !doubt.empty()) log_warning("{}", doubt);
}

// Reads the options again after SIGUSR2. True if they were good; then `config` has them.
bool read_again(UpArguments arguments, const SharedConfig& config) {
  AllOptions options;
  OptionTable table;
  const Result<> read = read_options(&arguments, &options, &table);
  if (read) config.write(table.to_yaml(OptionTable::Which::kAll));
  if (!read) complain("up", "options read again, but not used: " + read.error().text());
  return read.has_value();
}

int up(UpArguments& arguments) {
  AllOptions options;
  OptionTable table;
  refuse_if(sort_out(&arguments));
  refuse_if(read_options(&arguments, &options, &table));
  listen_to_signals();
  start_logging("rumi", false, /*quiet=*/true);
  fail_if(check_place(options));
  if (!arguments.snapshot.empty()) {
    fail_if(check_mask_stays(options.camera_driver.mask, options.up.input, arguments.snapshot));
    fail_if(check_output_folder(arguments.snapshot));
  }
  tell_of_map(options, arguments.fresh);
  warn_of_little_space(options.map_server.database);
  const auto begin = std::chrono::system_clock::now().time_since_epoch();
  const int64_t begin_us = std::chrono::duration_cast<std::chrono::microseconds>(begin).count();
  const SharedConfig config(table.to_yaml(OptionTable::Which::kAll));
  SupervisorOptions supervision;
  supervision.settle = std::chrono::milliseconds(std::llround(options.up.settle_s * 1e3));
  Supervisor supervisor(processes(options.up, config.file(), arguments), supervision, say);
  // The first snapshot is taken while all processes except the source can still tell their status, the last one when
  // the last poses have arrived.
  Supervisor::Hooks hooks;
  hooks.reload = [&] { return g_reload.exchange(false) && read_again(arguments, config); };
  Result<> snapshot_taken;
  if (!arguments.snapshot.empty()) snapshot_taken = Error{"no snapshot was written, as all was to end at once"};
  const auto snapshot = [&](bool is_last) {
    snapshot_taken = supervisor.run_beside(
        snapshot_process(options, config.file(), arguments.snapshot, begin_us, is_last), g_at_once);
  };
  if (!arguments.snapshot.empty()) {
    hooks.before_stop = [&] { snapshot(false); };
    hooks.before_last_stage = [&] { snapshot(true); };
  }
  Result<> result = supervisor.run(g_stop, g_at_once, hooks);
  if (result) result = snapshot_taken;
  if (result && arguments.snapshot.empty() && is_file(options.map_server.database))
    say("rumi", fmt::format("map: {0}; `rumi export-map {0} -o FOLDER --format tum` writes its poses",
                            options.map_server.database));
  if (!result) complain("up", result.error().text());
  for (const std::string& complaint : supervisor.complaints()) complain("up", complaint);
  return !result ? 1 : supervisor.not_all() ? kNotAll : 0;
}

}  // namespace

void add_up_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<UpArguments>();
  CommandLine* command =
      app.add_command("up", "Run the five processes on LCM and watch over them until the input ends");
  command
      ->add_option("CONFIG", arguments->first,
                   "YAML file with options such as config/rumi.yaml (its name ends in .yaml); may be left out")
      ->type_name("FILE");
  command->add_option(
      "INPUT", arguments->second,
      "for camera_driver: a camera or a recording; without it up.input of CONFIG, or images from elsewhere "
      "(lcm-logplayer)");
  command->add_option("--config", arguments->config, "the same as CONFIG")->type_name("FILE");
  command->add_option("-l,--lcm-url", arguments->up.lcm_url, "LCM URL; wins over up.lcm_url")->type_name("URL");
  command->add_option("--channel-prefix", arguments->up.channel_prefix,
                      "put before every channel name (several robots on one bus); wins over up.channel_prefix");
  command->add_option("-c,--channel", arguments->up.channel, "channel of the camera images; wins over up.channel");
  command->add_option("--set", arguments->settings, "set one option, may be repeated; wins over CONFIG")
      ->type_name("KEY=VALUE")
      .one_each();
  command
      ->add_option("-o,--output,--snapshot", arguments->asked_snapshot,
                   "write the outputs of `rumi replay` into this folder at the end")
      ->type_name("FOLDER");
  command->add_flag("--fresh", arguments->fresh,
                    "begin with an empty map: the one that is there, and its spool, get other names");
  command->add_flag("-v,--verbose", arguments->verbose, "all processes log more");
  command->add_flag("-q,--quiet", arguments->quiet, "all processes log warnings and errors only");
  arguments->up.channel.clear();
  camera_driver::add_flags(*command, {}, &arguments->camera_settings);
  command->footer(
      "Exit codes: 0 the recording was played, or it was ended by Ctrl-C; 1 it broke off, or --snapshot could not be "
      "written; 2 wrong options; 3 "
      "done, but not with all of the images: what is missing is said last. SIGUSR2: CONFIG is read again and the "
      "controls of a camera set as it "
      "says.");
  run_if_chosen(command, chosen, arguments, up);
}

}  // namespace rumi::tool
