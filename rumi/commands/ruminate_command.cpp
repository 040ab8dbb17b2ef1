// SPDX-License-Identifier: BSD-3-Clause
// rumi ruminate WINDOW...: rebuilds windows from their files, without a running system.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>

#include "base/files/file_access.h"
#include "base/files/scratch_folder.h"
#include "base/files/whole_file.h"
#include "base/running/failures.h"
#include "base/running/log.h"
#include "base/text/json_text.h"
#include "base/this_process/standard_output.h"
#include "bus/process/process.h"
#include "bus/transport/bus.h"
#include "bus/wire/submap_update.h"
#include "formats/truth/truth.h"
#include "map_server/outputs/trajectory_file.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/run/all_options.h"
#include "rumi/windows/window_report.h"
#include "ruminator/colmap_builder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

struct Arguments : OptionFlags {
  std::vector<std::string> windows;
  std::string out, truth;
  bool keep_work = false, json = false, quiet = false, verbose = false;
  TruthOptions truth_options;
};

std::atomic<bool> g_cancel = false;

void cancel_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_cancel = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

// Returns the files of windows. An argument that is a folder stands for its windows, sorted by session and number.
std::vector<std::string> window_files(const std::vector<std::string>& arguments) {
  std::vector<std::string> files;
  for (const std::string& argument : arguments) {
    std::error_code error;
    if (!fs::is_directory(argument, error)) {
      files.push_back(argument);
      continue;
    }
    std::vector<std::string> inside;
    for (const auto& entry : fs::directory_iterator(argument, error))
      if (entry.path().extension() == ".window") inside.push_back(entry.path().string());
    // Names are numbers without leading zeros, so a shorter name is a smaller number.
    std::sort(inside.begin(), inside.end(), [](const std::string& a, const std::string& b) {
      return a.size() != b.size() ? a.size() < b.size() : a < b;
    });
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

Result<> write_results(const Arguments& arguments, const std::string& name, const Submap& submap) {
  const fs::path base = fs::path(arguments.out) / name;
  const std::vector<uint8_t> bytes = encode_message(make_submap_update(submap, 0));
  WholeFile file(base.string() + ".submap");
  file.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (const Result<> written = file.commit(); !written) return written;
  return map_server::write_submap_tum(submap, base.string() + ".txt");
}

class Ruminate {
 public:
  Ruminate(const Arguments& arguments, const ruminator::BuildOptions& options, std::vector<TimedPose> truth)
      : arguments_(arguments), colmap_(ruminator::colmap_builder(options)), truth_(std::move(truth)) {}

  // Returns the number of windows that were not rebuilt.
  int run(const std::vector<std::string>& files) {
    if (!arguments_.json) fmt::print("{}\n", window_table_header(!truth_.empty()));
    int failures = 0;
    for (const std::string& file : files) {
      if (g_cancel) break;
      failures += !rebuild(file);
    }
    return failures;
  }
  Result<> write_csv() const {
    if (arguments_.out.empty()) return {};
    WholeFile file((fs::path(arguments_.out) / "windows.csv").string());
    file.write(window_csv_header() + "\n");
    for (const WindowRow& row : rows_) file.write(window_csv_line(row) + "\n");
    return file.commit();
  }

 private:
  bool rebuild(const std::string& file) {
    const std::string name = fs::path(file).stem().string();
    const Result<ruminator::WindowJobFile> read = ruminator::read_window_job(file);
    if (read && read->broken_images > 0)
      complain("ruminate", fmt::format("{}: {} broken images left out", file, read->broken_images));
    ruminator::BuildResult result;
    if (read)
      result = build(name, read->job);
    else
      result.submap = read.error();
    // If the images of a window cannot be read, its row still says which window it is.
    const ruminator::RuminationWindow window =
        read ? read->job.window : ruminator::read_window_manifest(file).value_or(ruminator::WindowJob()).window;
    rows_.push_back(make_window_row(name, window, result, truth_));
    const WindowRow& row = rows_.back();
    fmt::print("{}\n", arguments_.json ? json_text(to_json(row)) : window_table_line(row, !truth_.empty()));
    flush_stdout();
    if (!result.submap) return false;
    if (arguments_.out.empty()) return true;
    const Result<> written = write_results(arguments_, name, *result.submap);
    if (!written) complain("ruminate", written.error().text());
    return written.has_value();
  }

  ruminator::BuildResult build(const std::string& name, const ruminator::WindowJob& job) {
    const fs::path in = arguments_.keep_work ? fs::path(arguments_.out) : fs::path(scratch_folder(arguments_.out));
    const std::string work =
        (in / (arguments_.keep_work ? name + ".work" : fmt::format("rumi-{}-{}", getpid(), name))).string();
    ruminator::BuildResult result;
    try {
      result = colmap_.builder(
          job, work, [&](const ruminator::BuildProgress& progress) { show(name, progress); }, g_cancel);
    } catch (const std::exception& e) {
      result.submap = Error{reason_of(e)};
    }
    clear_line();
    std::error_code ignored;
    if (!arguments_.keep_work) fs::remove_all(work, ignored);
    if (result.cancelled && !result.submap) result.submap = Error{"called off"};
    return result;
  }

  // Shows the progress on a terminal, in one line that is printed again and again.
  void show(const std::string& name, const ruminator::BuildProgress& progress) {
    if (arguments_.quiet || !isatty(STDERR_FILENO)) return;
    constexpr const char* kStages[] = {"extracting", "matching", "mapping"};
    const std::string rest = progress.remaining_s < 0 ? "" : fmt::format(", about {:.0f} s left", progress.remaining_s);
    fmt::print(stderr, "\r{}: {} {:.0f} %{}\x1b[K", name, kStages[static_cast<int>(progress.stage)],
               100 * progress.fraction, rest);
    line_is_shown_ = true;
  }
  void clear_line() {
    if (line_is_shown_) fmt::print(stderr, "\r\x1b[K");
    line_is_shown_ = false;
  }

  const Arguments& arguments_;
  ruminator::ColmapBuilder colmap_;
  std::vector<TimedPose> truth_;
  std::vector<WindowRow> rows_;
  bool line_is_shown_ = false;
};

int ruminate(const Arguments& arguments) {
  AllOptions options;
  OptionTable table;
  describe(table, options);
  load(table, arguments);
  const std::vector<std::string> files = window_files(arguments.windows);
  if (files.empty()) {
    const std::string why = why_unreadable(arguments.windows.front());
    fail_if(fmt::format("{}: {}", arguments.windows.front(), why.empty() ? "no *.window in it" : why));
  }
  TruthFile truth;
  if (!arguments.truth.empty()) truth = read_groundtruth(arguments.truth, arguments.truth_options);
  fail_if(truth.error);
  if (!arguments.out.empty()) {
    std::error_code error;
    fs::create_directories(arguments.out, error);
    if (error) fail_if(fmt::format("{}: cannot be made: {}", arguments.out, error.message()));
  }
  start_logging("rumi", arguments.verbose, arguments.quiet);
  for (const std::string& note : truth.notes) log_warning("{}", note);
  cancel_on_signals();
  Ruminate command(arguments, options.ruminator.build, std::move(truth.poses));
  const int failures = command.run(files);
  fail_if(command.write_csv());
  if (g_cancel) fail_if("called off");
  return failures == 0 ? 0 : 1;
}

}  // namespace

void add_ruminate_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("ruminate", "Rebuild windows from their files, one after another");
  command->add_option("WINDOW", arguments->windows, "*.window of a spool or of `rumi replay`, or a folder of them")
      ->required();
  command
      ->add_option("-o,--output", arguments->out,
                   "folder for windows.csv and, per window, its back submap (.submap) and its path (.txt, TUM)")
      ->type_name("FOLDER");
  command
      ->add_option("--truth,--groundtruth", arguments->truth,
                   "true path, see `rumi evaluate`: adds the error of each back submap")
      ->type_name("FILE");
  command
      ->add_option("--truth-rate,--groundtruth-rate", arguments->truth_options.frames_per_second,
                   "the truth counts images at this rate, Hz, see `rumi evaluate`; 0: it has times")
      ->not_negative()
      ->show_default();
  command->add_flag("--keep-work", arguments->keep_work,
                    "leave COLMAP's files and log of windows that fail, as WINDOW.work in the output folder or here");
  command->add_flag("--json", arguments->json, "a line of JSON per window instead of the table");
  add_option_flags(command, arguments.get());
  command->add_flag("-q,--quiet", arguments->quiet, "warnings and errors only");
  command->add_flag("-v,--verbose", arguments->verbose, "log more");
  command->footer("Exit code: 0 if all could be rebuilt, 1 if not, 2 for a wrong command line.");
  run_if_chosen(command, chosen, arguments, ruminate);
}

}  // namespace rumi::tool
