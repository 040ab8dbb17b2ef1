// SPDX-License-Identifier: BSD-3-Clause
// rumi up CONFIG: the five processes on LCM, started, watched and stopped together.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "base/command_line.h"
#include "base/exit_codes.h"
#include "base/failures.h"
#include "base/log.h"
#include "base/scratch_folder.h"
#include "bus/process/process.h"
#include "bus/transport/lcm_bus.h"
#include "bus/wire/camera_file.h"
#include "camera_driver/flags.h"
#include "camera_driver/open_source.h"
#include "map_server/store/map_store.h"
#include "rumi/commands/commands.h"
#include "rumi/outputs/output_folder.h"
#include "rumi/outputs/reserved_space.h"
#include "rumi/run/all_options.h"
#include "rumi/run/map_before.h"
#include "rumi/run/other_system.h"
#include "rumi/run/program_folder.h"
#include "rumi/run/supervisor.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string first, second;  // CONFIG, INPUT, or one of them
  std::string config, input, snapshot;
  std::optional<std::string> asked_snapshot;
  UpOptions up;  // what flags say; empty: nothing
  std::vector<std::string> settings;
  std::vector<std::string> camera_settings;  // by flags, for a camera_driver
  std::string calibration;                   // --camera without INPUT: of images from elsewhere
  bool fresh = false, verbose = false, quiet = false;
};

constexpr std::chrono::milliseconds kListen{500};  // for others; all of them answer at once

std::string default_url() {
  const char* variable = std::getenv("LCM_DEFAULT_URL");
  return variable && *variable ? variable : kDefaultLcmUrl;
}

std::atomic<bool> g_stop = false, g_at_once = false, g_reload = false;

void listen_to_signals() {
  struct sigaction action {};
  // Who asks twice does not want to wait.
  action.sa_handler = [](int) {
    if (g_stop.exchange(true)) g_at_once = true;
  };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, &action, nullptr);  // the terminal was closed: what was asked for is written all the same
  action.sa_handler = [](int) { g_reload = true; };
  sigaction(SIGUSR2, &action, nullptr);
}

// The options as all processes are to have them, in a file that lives as long as this object.
class SharedConfig {
 public:
  // Throws std::runtime_error.
  explicit SharedConfig(const std::string& yaml) {
    std::string name = (fs::path(scratch_folder()) / "rumi-up-XXXXXX").string();
    const int fd = mkstemp(name.data());
    if (fd < 0) throw std::runtime_error(fmt::format("{}: cannot be made: {}", name, std::strerror(errno)));
    file_ = name;
    close(fd);
    write(yaml);
  }
  // Throws std::runtime_error.
  void write(const std::string& yaml) const {
    std::ofstream stream(file_);
    if (!(stream << yaml << std::flush)) throw std::runtime_error(fmt::format("{}: cannot be written", file_));
  }
  ~SharedConfig() { unlink(file_.c_str()); }
  SharedConfig(const SharedConfig&) = delete;
  SharedConfig& operator=(const SharedConfig&) = delete;
  const std::string& file() const { return file_; }

 private:
  std::string file_;
};

// Not by fmt::print, which throws where nobody reads any more: a terminal that was closed.
void tell(const std::string& text) { std::fputs(text.c_str(), stderr); }
void say(const std::string& name, const std::string& line) { tell(fmt::format("{:>16}| {}\n", name, line)); }

std::vector<std::string> bus_flags(const UpOptions& up) {
  std::vector<std::string> flags;
  if (!up.lcm_url.empty()) flags.insert(flags.end(), {"--lcm-url", up.lcm_url});
  if (!up.channel_prefix.empty()) flags.insert(flags.end(), {"--channel-prefix", up.channel_prefix});
  flags.insert(flags.end(), {"--channel", up.channel});
  return flags;
}

// map_server is stopped after the others, so that what they hand on at their end still arrives.
std::vector<Supervised> processes(const UpOptions& up, const std::string& config_file, const Arguments& arguments) {
  const fs::path folder = program_folder_of(own_folder());
  std::vector<Supervised> children;
  using Words = std::vector<std::string>;
  const auto add = [&](const std::string& name, int stop_stage, const Words& more = {}) {
    Supervised child{name, {(folder / name).string()}, false, stop_stage};
    child.command.insert(child.command.end(), more.begin(), more.end());
    child.command.insert(child.command.end(), {"--config", config_file});
    for (const std::string& flag : bus_flags(up)) child.command.push_back(flag);
    if (arguments.verbose) child.command.push_back("--verbose");
    if (arguments.quiet) child.command.push_back("--quiet");
    children.push_back(std::move(child));
  };
  // Listeners first, the source last.
  const std::string& calibration = arguments.calibration;
  add("map_server", 1);
  add("ruminator", 0, calibration.empty() ? Words() : Words{"--set", "ruminator.camera_file=" + calibration});
  children.back().finishes = true;
  if (up.viewer) add("viewer_offscreen", 0);
  add("front_tracker", 0, calibration.empty() ? Words() : Words{"--camera", calibration});
  if (!up.input.empty()) {
    add("camera_driver", 0, {up.input});
    children.back().source = true;
    children.back().reloads = true;
    children.back().fails_once = !camera_driver::is_camera(up.input);  // a camera may be plugged in again
  }
  return children;
}

// The last one tells what it wrote; --update: what an earlier one knew stays.
Supervised snapshot_process(const AllOptions& options, const std::string& config_file, const std::string& out,
                            int64_t since_us, bool is_last) {
  const UpOptions& up = options.up;
  std::vector<std::string> command{(own_folder() / "rumi").string(), "snapshot", "-o", out};
  command.insert(command.end(), {"--since", std::to_string(since_us), is_last ? "--update" : "--quiet"});
  if (!up.lcm_url.empty()) command.insert(command.end(), {"--lcm-url", up.lcm_url});
  if (!up.channel_prefix.empty()) command.insert(command.end(), {"--channel-prefix", up.channel_prefix});
  const bool has_its_times = !options.camera_driver.loop && !options.camera_driver.live_stamps;
  if (is_last && has_its_times && !up.input.empty() && !camera_driver::is_camera(up.input))
    command.insert(command.end(), {"--images", up.input, "--config", config_file});
  return {"snapshot", command};
}

bool is_file(const std::string& database) { return !database.empty() && database != map_server::kInMemory; }

// The first thing that is said, and --fresh. Throws std::runtime_error with a message for the user.
void tell_of_map(const AllOptions& options, bool fresh) {
  const std::string& database = options.map_server.database;
  if (options.map_server.localize_only && !is_file(database))
    throw std::runtime_error("map_server.localize_only needs a map: name its file with map_server.database");
  if (!is_file(database)) return;
  const std::optional<std::string> before = describe_map_before(database);
  if (options.map_server.localize_only && !fs::exists(database))
    throw std::runtime_error(fmt::format("{}: there is no such file to localize in (map_server.database)", database));
  if (options.map_server.localize_only && before) {
    say("rumi", fmt::format("map: {}, {}, stays as it is", database, *before));
  } else if (fresh) {
    const std::string aside = set_aside(database, options.ruminator.spool);
    say("rumi", fmt::format("map: {}, a new one{}", database,
                            aside.empty() ? "" : fmt::format("; that of before is {} now", aside)));
  } else if (before) {
    say("rumi", fmt::format("map: {} goes on, {}; --fresh begins anew", database, *before));
  } else {
    say("rumi", fmt::format("map: {}, a new one", database));
  }
}

// What would end all again soon after its start, and disturb others meanwhile. Returns it for a person, or an empty
// string; throws std::runtime_error for the same.
std::string why_not_here(const AllOptions& options) {
  const UpOptions& up = options.up;
  const std::string& database = options.map_server.database;
  if (is_file(database) && !options.map_server.localize_only) const map_server::DatabaseLock is_free(database);
  ChannelNames names;
  names.prefix = up.channel_prefix;
  names.camera = up.channel;
  std::string error;
  const std::unique_ptr<LcmBus> bus = LcmBus::open(up.lcm_url.empty() ? default_url() : up.lcm_url, names, &error);
  if (!bus) return error;
  const std::string camera_channel = up.input.empty() ? "" : names.on_wire(channels::kCamera);
  return find_other_system(*bus, {{"map_server", "ruminator", "front_tracker"}, camera_channel}, kListen);
}

// A live system goes on for who knows how long.
void warn_of_little_space(const std::string& database) {
  constexpr int64_t kImages = 1000;
  const fs::path folder = fs::absolute(database).parent_path();
  if (const std::string doubt = doubt_about_space(folder.string(), kImages); !doubt.empty()) log_warning("{}", doubt);
}

bool is_yaml(const std::string& name) {
  const std::string extension = fs::path(name).extension().string();
  return extension == ".yaml" || extension == ".yml";
}

// CONFIG and INPUT, of which each may be left out. What is wrong, or an empty string.
std::string sort_out(Arguments* arguments) {
  arguments->snapshot = arguments->asked_snapshot.value_or("");
  if (arguments->asked_snapshot && arguments->snapshot.empty()) return "--output is empty: give a folder";
  for (const std::string& name : {arguments->first, arguments->second}) {
    if (name.empty()) continue;
    std::string& meant = is_yaml(name) ? arguments->config : arguments->input;
    if (!meant.empty())
      return fmt::format("{} and {}: give one INPUT, and one CONFIG, whose name ends in .yaml", meant, name);
    meant = name;
  }
  return {};
}

void take(const std::string& flag, std::string* option) {
  if (!flag.empty()) *option = flag;
}

// Flags for a camera_driver where there is none; --camera is then for those who need a calibration. What is wrong, or
// an empty string.
std::string sort_out_camera(const AllOptions& options, Arguments* arguments) {
  if (!options.up.input.empty()) return {};
  for (const std::string& setting : arguments->camera_settings) {
    if (!setting.starts_with("--camera "))
      return fmt::format("{}: there is no INPUT that this could be meant for", setting.substr(0, setting.find(' ')));
    arguments->calibration = options.camera_driver.camera_file;
    const CameraFileResult read = read_camera_file(arguments->calibration);
    if (!read.ok()) return read.error;
  }
  return {};
}

// What is wrong with them, or an empty string.
std::string read_options(Arguments* arguments, AllOptions* options, OptionTable* table) {
  describe(*table, *options);
  std::vector<std::string> settings = arguments->settings;
  settings.insert(settings.end(), arguments->camera_settings.begin(), arguments->camera_settings.end());
  const std::string problem = load_options(*table, arguments->config, settings);
  if (!problem.empty()) return problem;
  take(arguments->input, &options->up.input);
  take(arguments->up.lcm_url, &options->up.lcm_url);
  take(arguments->up.channel_prefix, &options->up.channel_prefix);
  take(arguments->up.channel, &options->up.channel);
  if (arguments->fresh && options->map_server.localize_only)
    return "--fresh: there would be no map to localize in (map_server.localize_only)";
  const std::string unused = sort_out_camera(*options, arguments);
  if (!unused.empty()) return unused;
  // Also a map that goes on: map_server has it open.
  if (!arguments->snapshot.empty() && is_file(options->map_server.database)) {
    const std::string replaced = check_map_stays(options->map_server.database, arguments->snapshot);
    if (!replaced.empty()) return replaced;
  }
  return check(options->camera_driver);
}

// On SIGUSR2. True if the shared options are new.
bool read_again(Arguments arguments, const SharedConfig& config) {
  AllOptions options;
  OptionTable table;
  const std::string error = read_options(&arguments, &options, &table);
  if (error.empty()) config.write(table.to_yaml(OptionTable::Which::kAll));
  if (!error.empty()) tell(fmt::format("rumi up: options read again, but not used: {}\n", error));
  return error.empty();
}

int up(Arguments& arguments) {
  AllOptions options;
  OptionTable table;
  std::string error = sort_out(&arguments);
  if (error.empty()) error = read_options(&arguments, &options, &table);
  if (!error.empty()) {
    tell(fmt::format("rumi up: {}\n", error));
    return 2;
  }
  bool not_all = false;
  listen_to_signals();
  start_logging("rumi", false, /*quiet=*/true);
  try {
    if (const std::string why = why_not_here(options); !why.empty()) throw std::runtime_error(why);
    if (!arguments.snapshot.empty())
      if (const std::string why = check_output_folder(arguments.snapshot); !why.empty()) throw std::runtime_error(why);
    tell_of_map(options, arguments.fresh);
    warn_of_little_space(options.map_server.database);
    const auto begin = std::chrono::system_clock::now().time_since_epoch();
    const int64_t begin_us = std::chrono::duration_cast<std::chrono::microseconds>(begin).count();
    const SharedConfig config(table.to_yaml(OptionTable::Which::kAll));
    SupervisorOptions supervision;
    supervision.settle = std::chrono::milliseconds(std::llround(options.up.settle_s * 1e3));
    Supervisor supervisor(processes(options.up, config.file(), arguments), supervision, say);
    // Once while everybody can still say how it went, and once when the last poses have arrived.
    Supervisor::Hooks hooks;
    hooks.reload = [&] { return g_reload.exchange(false) && read_again(arguments, config); };
    std::string snapshot_error = arguments.snapshot.empty() ? "" : "no snapshot was written, as all was to end at once";
    const auto snapshot = [&](bool is_last) {
      snapshot_error = supervisor.run_beside(
          snapshot_process(options, config.file(), arguments.snapshot, begin_us, is_last), g_at_once);
    };
    if (!arguments.snapshot.empty()) {
      hooks.before_stop = [&] { snapshot(false); };
      hooks.before_last_stage = [&] { snapshot(true); };
    }
    error = supervisor.run(g_stop, g_at_once, hooks);
    if (error.empty()) error = snapshot_error;
    not_all = supervisor.not_all();
  } catch (const std::exception& e) {
    error = reason_of(e);
  }
  if (error.empty() && arguments.snapshot.empty() && is_file(options.map_server.database))
    say("rumi", fmt::format("map: {0}; `rumi export-map {0} -o FOLDER --format tum` writes its poses",
                            options.map_server.database));
  if (!error.empty()) tell(fmt::format("rumi up: {}\n", error));
  if (not_all) tell("rumi up: not all of the recording is in the result: what is missing is said above\n");
  return !error.empty() ? 1 : not_all ? kNotAll : 0;
}

}  // namespace

void add_up_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
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
      "done, but not with all of the recording. SIGUSR2: CONFIG is read again and the controls of a camera set as it "
      "says.");
  command->on_chosen([arguments, chosen] { *chosen = [arguments] { return up(*arguments); }; });
}

}  // namespace rumi::tool
