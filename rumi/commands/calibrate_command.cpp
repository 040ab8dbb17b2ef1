// SPDX-License-Identifier: BSD-3-Clause
// rumi calibrate [SOURCE] -o camera.yaml: computes a camera's calibration from images of a board.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>

#include "base/files/whole_file.h"
#include "base/running/log.h"
#include "base/this_process/standard_output.h"
#include "rumi/calibration/capture.h"
#include "rumi/calibration/report.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/report/coverage_picture.h"
#include "viewer_offscreen/picture/draw_map.h"

namespace rumi::tool {
namespace {

struct Arguments : BusFlags {
  std::string source, file, picture, board = Board().to_string(), model = "pinhole";
  int every = 1;
  bool force = false, quiet = false;
  CalibratorOptions options;
};

constexpr std::chrono::milliseconds kRefresh{1000}, kSlowRefresh{5000};

std::atomic<bool> g_stop = false;

// The first Ctrl-C calibrates with the views so far; a second one ends the process at once.
void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = true; };
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

// Shows the progress while images come in: on a terminal as a picture that is redrawn, otherwise as a line now and
// then.
class Progress {
 public:
  // live: somebody holds the board and can be advised.
  Progress(bool quiet, bool live) : quiet_(quiet), live_(live), terminal_(isatty(STDERR_FILENO) != 0) {}

  // waiting: text that is printed as long as no image has come.
  void tick(const ViewCollector& collector, const std::string& waiting) {
    const auto now = std::chrono::steady_clock::now();
    if (quiet_ || now - last_ < (terminal_ || live_ ? kRefresh : kSlowRefresh)) return;
    last_ = now;
    if (collector.counts().images == 0)
      fmt::print(stderr, "{}\n", waiting);
    else if (terminal_)
      show(collector);
    else
      fmt::print(stderr, "so far {}{}\n", collector.counts().to_string(), live_ ? advice(collector) : "");
  }

 private:
  static std::string advice(const ViewCollector& collector) {
    const std::vector<std::string> missing = collector.coverage().missing();
    return missing.empty() ? "; enough" : "; " + missing.front();
  }
  void show(const ViewCollector& collector) const {
    constexpr const char* kClearScreen = "\x1B[H\x1B[2J";
    fmt::print(stderr, "{}{}\n{}", kClearScreen, collector.counts().to_string(), collector.coverage().to_text());
    if (!live_) return;
    for (const std::string& what : collector.coverage().missing()) fmt::print(stderr, "  - {}\n", what);
    fmt::print(stderr, "Ctrl-C: calibrate with what there is\n");
  }

  bool quiet_, live_, terminal_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

Result<> collect_live(const Arguments& arguments, Progress& progress, ViewCollector* collector) {
  const std::unique_ptr<LcmBus> bus = open_bus(arguments);
  collect_from_bus(*bus, collector);
  const std::string waiting = fmt::format("no image yet on {} ({}); is `rumi camera_driver` running?",
                                          arguments.names.on_wire(channels::kCamera), arguments.lcm_url);
  while (!g_stop && collector->problem().empty()) {
    bus->dispatch(50);
    progress.tick(*collector, waiting);
    if (collector->counts().taken > 0 && collector->coverage().missing().empty()) break;
  }
  if (!collector->problem().empty()) return Error{collector->problem()};
  return {};
}

Result<> collect(const Arguments& arguments, ViewCollector* collector) {
  stop_on_signals();
  Progress progress(arguments.quiet, arguments.source.empty());
  if (arguments.source.empty()) return collect_live(arguments, progress, collector);
  const auto go_on = [&] {
    progress.tick(*collector, "");
    return !g_stop;
  };
  return collect_from_recording(arguments.source, arguments.names.camera, arguments.every, go_on, collector);
}

Result<> write_text(const std::string& file, const std::string& text) {
  WholeFile out(file);
  out.write(text);
  return out.commit();
}

std::string with_missing(std::string text, const ViewCollector& collector) {
  for (const std::string& what : collector.coverage().missing()) text += "\n  missing: " + what;
  return text;
}

void calibrate_from(const Arguments& arguments, const ViewCollector& collector) {
  const std::string source = arguments.source.empty() ? "CAMERA" : arguments.source;
  if (collector.counts().taken == 0) fail_if(why_no_views(collector, source));
  if (!arguments.quiet)
    fmt::print("{}: {}\n{}", source, collector.counts().to_string(), collector.coverage().to_text());
  flush_stdout();
  if (!arguments.picture.empty()) fail_if(viewer_offscreen::write_png(draw_coverage(collector), arguments.picture));
  const Camera::Model model = arguments.model == "pinhole" ? Camera::Model::kPinhole : Camera::Model::kKannalaBrandt;
  const Result<Calibration> calibration = calibrate(collector.board(), collector.taken(), collector.spare(),
                                                    collector.image_size(), model, arguments.options);
  if (!calibration) fail_if(with_missing(calibration.error().text(), collector));
  if (!arguments.quiet) fmt::print("{}", describe(*calibration));
  if (!calibration->doubts.empty() && !arguments.force)
    fail_if(with_missing(fmt::format("{}", fmt::join(calibration->doubts, "\n  ")), collector) +
            "\n  nothing was written (--force writes it anyway)");
  fail_if(write_text(arguments.file, calibration_to_yaml(*calibration, collector)));
  for (const std::string& doubt : calibration->doubts) fmt::print(stderr, "doubtful: {}\n", doubt);
  for (const std::string& what : collector.coverage().missing()) fmt::print(stderr, "would be better: {}\n", what);
  if (!arguments.quiet) fmt::print("{}\n", arguments.file);
}

void calibrate(const Arguments& arguments) {
  const Board board = value_or_refuse(parse_board(arguments.board));
  fail_if(check_writable(arguments.file));
  if (!arguments.picture.empty()) fail_if(check_writable(arguments.picture));
  start_logging("rumi", false, arguments.quiet);
  ViewCollector collector(board, {});
  fail_if(collect(arguments, &collector));
  calibrate_from(arguments, collector);
}

}  // namespace

void add_calibrate_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("calibrate", "Calibrate a camera from images of a board (see draw-board)");
  command->add_option("SOURCE", arguments->source,
                      "images of the board: a folder, a dataset folder, a video, an lcm log or a ROS bag; without it: "
                      "those that come in live, "
                      "until there are enough or Ctrl-C");
  command->add_option("-o,--output", arguments->file, "the calibration, our YAML")->type_name("FILE").required();
  command
      ->add_option("--picture", arguments->picture,
                   "PNG of where in the image and from which sides the board was seen; also where the calibration is "
                   "refused")
      ->type_name("FILE");
  command->add_option("--board", arguments->board, "as written below it; columns and rows count squares")
      ->type_name(kBoardSyntax)
      ->show_default();
  command->add_option("--model", arguments->model, "fisheye: of Kannala and Brandt, from some 110 degrees of view on")
      ->one_of({"pinhole", "fisheye"})
      ->show_default();
  command->add_option("--every", arguments->every, "look at every Nth image of a recording only")
      ->in_range(1, 1'000'000)
      ->show_default();
  command->add_option("--max-rms", arguments->options.max_rms_px, "refuse a reprojection error above it, px")
      ->positive()
      ->show_default();
  command->add_flag("--force", arguments->force, "write a calibration that is refused because it is doubtful");
  command
      ->add_option("-c,--channel", arguments->names.camera,
                   "channel of the images, live or in a log; topic in a ROS bag")
      ->show_default();
  add_bus_flags(command, arguments.get());
  command->add_flag("-q,--quiet", arguments->quiet, "warnings and errors only");
  run_if_chosen(command, chosen, arguments, [](const Arguments& these) { calibrate(these); });
}

}  // namespace rumi::tool
