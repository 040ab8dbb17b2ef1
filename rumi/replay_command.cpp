// SPDX-License-Identifier: BSD-3-Clause
// rumi replay INPUT -o OUT
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>

#include "camera_driver/image_source.h"
#include "map_server/output_file.h"
#include "rumi/all_options.h"
#include "rumi/commands.h"
#include "rumi/metered_bus.h"
#include "rumi/output_folder.h"
#include "rumi/replay.h"
#include "rumi/run_record.h"
#include "rumi/run_summary.h"
#include "rumi/window_report.h"
#include "ruminator/spool.h"
#include "ruminator/window_message.h"

namespace rumi {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::ordered_json;
namespace fs = std::filesystem;

struct Arguments {
  std::string input, out, config, log;
  std::vector<std::string> settings;
  bool quiet = false, verbose = false;
};

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;
}

// On a terminal one line, over and over; elsewhere a line in the log now and then.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet) : quiet_(quiet) {}
  ~ProgressLine() {
    if (shown_) fmt::print(stderr, "\r\x1b[K");
  }
  void update(Replay& replay) {
    if (quiet_ || seconds_since(last_) < (terminal_ ? 0.5 : 10)) return;
    const ReplayProgress progress = replay.progress();
    if (!terminal_ && progress.frames - told_ < kLeastShare * static_cast<double>(progress.total)) return;
    const std::string text =
        describe_progress(progress.frames, progress.total, seconds_since(begin_)) + "; " + progress.state;
    if (terminal_)
      fmt::print(stderr, "\r{}\x1b[K", text);
    else
      spdlog::info("{}", text);
    last_ = Clock::now();
    told_ = progress.frames;
    shown_ = terminal_;
  }

 private:
  static constexpr double kLeastShare = 0.05;  // of all images, between two lines in a log
  bool quiet_, terminal_ = isatty(STDERR_FILENO), shown_ = false;
  Clock::time_point begin_ = Clock::now(), last_ = begin_;
  int64_t told_ = 0;
};

// OUT/windows: the windows as files that `rumi ruminate` rebuilds, and in OUT/windows.csv what came of them here.
class WindowOutput {
 public:
  explicit WindowOutput(const std::string& out) : out_(out) {}

  // Removes the windows of an earlier run. What is wrong, or an empty string.
  std::string prepare() {
    std::error_code error;
    fs::create_directories(out_ / "windows", error);
    for (fs::directory_iterator it(out_ / "windows", error), end; !error && it != end; it.increment(error))
      if (it->path().extension() == ".window") fs::remove(it->path(), error);
    return error ? fmt::format("{}: {}", (out_ / "windows").string(), error.message()) : "";
  }
  ReplayHooks hooks() {
    return {[this](const WindowJob& job) {
              ++complete_;
              const std::string name = to_string(name_of(job.window)) + ".window";
              const std::string error = write_window_job((out_ / "windows" / name).string(), job);
              if (error_.empty()) error_ = error;
            },
            [this](const RuminationWindow& window, const BuildResult& result) {
              rows_.push_back(make_window_row(to_string(name_of(window)), window, result));
            }};
  }
  std::string finish() {
    OutputFile csv((out_ / "windows.csv").string());
    csv.write(window_csv_header() + "\n");
    for (const WindowRow& row : rows_) csv.write(window_csv_line(row) + "\n");
    const std::string error = csv.commit();
    return error_.empty() ? error : error_;
  }
  // A line for each that gave nothing.
  std::vector<std::string> failures() const {
    std::vector<std::string> lines;
    for (const WindowRow& row : rows_)
      if (!row.ok)
        lines.push_back(fmt::format("window {}, {}: {}", row.window.id, describe(row.window), row.result.failure));
    return lines;
  }
  ordered_json counts() const {
    return {{"complete", complete_},
            {"rebuilt", std::count_if(rows_.begin(), rows_.end(), [](const WindowRow& row) { return row.ok; })}};
  }

 private:
  fs::path out_;
  int complete_ = 0;
  std::vector<WindowRow> rows_;
  std::string error_;  // the first
};

// All that differs from run to run is under cpu_ms_per_frame, cpu_s, wall_s and peak_rss_mb.
ordered_json run_record(const Arguments& arguments, const OptionTable& table, Replay& replay,
                        const WindowOutput& windows, double wall_s) {
  const int64_t frames = replay.progress().frames;
  ordered_json run{{"finished", true},
                   {"command", "replay"},
                   {"input", arguments.input},
                   {"options", options_to_json(table.to_yaml())},
                   {"images", frames}};
  const SkippedFrames& skipped = replay.skipped();
  run["skipped_images"] = {{"malformed", skipped.malformed},
                           {"duplicate", skipped.duplicate},
                           {"out_of_order", skipped.out_of_order},
                           {"unreadable", skipped.unreadable},
                           {"wrong_size", skipped.wrong_size}};
  run["counts"] = counts_to_json(count(replay.atlas()));
  run["windows"] = windows.counts();
  run["channels"] = ordered_json::object();
  for (const ChannelCounts& channel : replay.channel_counts()) {
    run["channels"][channel.channel] = {
        {"received", channel.received}, {"dropped", channel.dropped}, {"undecodable", channel.undecodable}};
  }
  run["cpu_ms_per_frame"] = ordered_json::object();
  for (const auto& [name, cpu_s] : replay.cpu_s()) {
    run["cpu_ms_per_frame"][name] =
        frames > 0 ? ordered_json(cpu_s * 1e3 / static_cast<double>(frames)) : ordered_json();
  }
  run["cpu_s"] = process_cpu_s();
  run["wall_s"] = wall_s;
  run["peak_rss_mb"] = peak_rss_mb();
  return run;
}

std::string write_everything(Replay& replay, const std::string& out) {
  if (std::string error = write_run_outputs(replay.atlas(), out); !error.empty()) return error;
  return replay.store().write_copy((std::filesystem::path(out) / "map.db").string());
}

void print_end(Replay& replay, const WindowOutput& windows, const std::string& out, double wall_s) {
  std::vector<std::string> left_out = rumi::left_out(replay.atlas());
  for (const std::string& line : windows.failures()) left_out.push_back(line);
  if (const SkippedFrames& skipped = replay.skipped(); skipped.total() > 0)
    left_out.push_back("of the recording: " + skipped.to_string());
  print_summary(count(replay.atlas()), left_out, out);
  fmt::print("{} images in {:.1f} s\n", replay.progress().frames, wall_s);
}

std::string begin_log(const Arguments& arguments, Replay* replay) {
  if (arguments.log.empty()) return {};
  std::error_code none;
  if (std::filesystem::equivalent(arguments.log, arguments.input, none))
    return fmt::format("--log {} is the input itself", arguments.log);
  return replay->record(arguments.log);
}

int replay(const Arguments& arguments) {
  AllOptions options;
  OptionTable table;
  describe(table, options);
  std::string error = load_options(table, arguments.config, arguments.settings);
  if (error.empty()) error = options.camera_driver.check();
  if (!error.empty()) {
    fmt::print(stderr, "rumi replay: {}\n", error);
    return 2;
  }
  start_logging("rumi", arguments.verbose, arguments.quiet);
  const auto begin = Clock::now();
  WindowOutput windows(arguments.out);
  AllOptions run_options = options;  // the table keeps what the user asked for
  run_options.viewer_offscreen.output = arguments.out;
  Replay replay(run_options, arguments.input, windows.hooks());
  error = prepare_output_folder(arguments.out);
  if (error.empty()) error = begin_log(arguments, &replay);
  if (error.empty()) error = windows.prepare();
  if (error.empty()) {
    ProgressLine line(arguments.quiet);
    while (replay.step()) line.update(replay);
    if (!replay.finish()) fmt::print(stderr, "rumi replay: not everything could be handed on at the end\n");
    error = replay.close_log();
  }
  if (error.empty()) error = windows.finish();
  if (error.empty()) error = write_everything(replay, arguments.out);
  const double wall_s = seconds_since(begin);
  if (error.empty()) error = write_run_json(arguments.out, run_record(arguments, table, replay, windows, wall_s));
  if (!error.empty()) {
    fmt::print(stderr, "rumi replay: {}\n", error);
    return 1;
  }
  if (!arguments.quiet) print_end(replay, windows, arguments.out, wall_s);
  return 0;
}

}  // namespace

void add_replay_command(CLI::App& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("replay", "Run all components on a recording in one process, as fast as possible, repeatably");
  command->add_option("INPUT", arguments->input, "dataset folder, folder of images, video or lcm log")->required();
  command
      ->add_option("-o,--output", arguments->out,
                   "folder; one with files that would be overwritten is refused, unless an earlier run made them")
      ->required();
  command->add_option("--log", arguments->log, "lcm log to write: every message on the bus, images included");
  command->add_option("--config", arguments->config, "YAML file with options, see config/rumi.yaml");
  command->add_option("--set", arguments->settings, "KEY=VALUE, may be repeated; wins over --config")
      ->allow_extra_args(false);
  command->add_flag("-q,--quiet", arguments->quiet, "warnings and errors only");
  command->add_flag("-v,--verbose", arguments->verbose, "log more: each window, submap and adjustment on its way");
  // The flags that camera_driver has too are short for options of its section.
  const auto shorthand = [&](const char* flag, const char* key, const char* help) {
    command->add_option_function<std::string>(
        flag,
        [arguments, key](const std::string& value) { arguments->settings.push_back(fmt::format("{}={}", key, value)); },
        help);
  };
  shorthand("--camera", "camera_driver.camera_file", "calibration file, instead of the one beside the data");
  shorthand("--every", "camera_driver.every", "every Nth frame only");
  shorthand("--start", "camera_driver.start", "leave out so much at the beginning, s");
  shorthand("--duration", "camera_driver.duration", "end after so much, s; 0: all");
  shorthand("--rate", "camera_driver.rate", "new times at this rate, Hz (needed for images without times)");
  shorthand("--encoding", "camera_driver.encoding", "grey, rgb, jpeg or auto");
  command->callback([arguments, chosen] { *chosen = [arguments] { return replay(*arguments); }; });
}

}  // namespace rumi
