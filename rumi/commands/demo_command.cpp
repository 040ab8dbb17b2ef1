// SPDX-License-Identifier: BSD-3-Clause
// rumi demo: shows on a rendered walk what Rumi is for. It needs no recording.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "base/files/whole_file.h"
#include "base/running/log.h"
#include "base/this_process/standard_output.h"
#include "bus/process/process.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/commands/demo_table.h"
#include "rumi/commands/progress_line.h"
#include "rumi/outputs/output_folder.h"
#include "rumi/outputs/run_summary.h"
#include "rumi/report/evaluation_plot.h"
#include "rumi/report/run_report.h"
#include "rumi/report/window_picture.h"
#include "rumi/windows/window_scene.h"
#include "synth/write_sequence.h"
#include "viewer_offscreen/picture/draw_map.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kSummary =
    "Render a walk on which the camera is lost, run Rumi on it, and show what became of it";

struct Arguments : OptionFlags {
  std::string out = "out/demo";
  synth::SynthOptions synth;
  bool verbose = false;
};

// Sets the user's options, then `settings`, which override them. Throws WrongOptions.
void set_options(OptionFlags flags, const std::vector<std::string>& settings, ReplayRun* run) {
  OptionTable table;
  describe(table, run->options);
  flags.settings.insert(flags.settings.end(), settings.begin(), settings.end());
  load(table, flags);
  run->options_yaml = table.to_yaml(OptionTable::Which::kAll);
}

class Demo {
 public:
  explicit Demo(const Arguments& arguments) : arguments_(arguments), out_(arguments.out) {}

  void run() {
    fail_if(prepare_folder());
    render();
    say("Following the camera by the front alone (no rebuilding)");
    const MeasuredRun front = replay("front_alone", {"ruminator.rebuild=false"}, "");
    say("The same with the whole of Rumi: what was lost is rebuilt by COLMAP, and all is joined");
    const MeasuredRun whole = replay("rumi", {}, log().string());
    say("Drawing, and writing the report");
    draw(whole);
    fmt::print("\n{}\n{}", demo_table(front, whole), demo_story(whole.outcome));
    tell_files();
    fail_if(write_run_json(out_.string(), {{"finished", true},
                                           {"command", "demo"},
                                           {"seed", arguments_.synth.seed},
                                           {"front_alone", to_json(front.evaluation)},
                                           {"rumi", to_json(whole.evaluation)}}));
  }

 private:
  fs::path sequence() const { return out_ / "sequence"; }
  fs::path truth() const { return sequence() / "groundtruth.txt"; }
  fs::path log() const { return out_ / "rumi" / "messages.lcm"; }

  // Makes the folder, or takes over the one of an earlier demo. An Error if it holds anything else.
  Result<> prepare_folder() const {
    std::error_code error;
    fs::create_directories(out_, error);
    if (!fs::is_directory(out_)) return Error{"cannot be made a folder", out_.string()};
    const ordered_json earlier = read_run_json(out_.string());
    if (!fs::is_empty(out_, error) && (earlier.is_null() || earlier.value("command", "") != "demo"))
      return Error{"holds files that are not of an earlier demo: choose another folder, or empty this one",
                   out_.string()};
    return write_run_json(out_.string(), {{"finished", false}, {"command", "demo"}});
  }

  void say(const std::string& what) {
    fmt::print("{}/4 {}\n", ++step_, what);
    flush_stdout();
  }

  void render() {
    say(
        fmt::format("Rendering a walk of {:.0f} s: about in a room, a fast turn through a doorway, dark and out of\n"
                    "    focus, and about in the next room. Neither room is seen from the other one.",
                    arguments_.synth.seconds));
    fs::remove_all(sequence());
    ProgressLine line(true);
    fail_if(synth::write_sequence(arguments_.synth, sequence().string(), /*overwrite=*/false, [&](int done, int all) {
      line.update(done, all, [&] { return fmt::format("    image {} of {}", done, all); });
      return true;
    }));
    line.erase();
  }

  MeasuredRun replay(const char* name, const std::vector<std::string>& settings, const std::string& log) {
    ReplayRun run{.input = sequence().string(), .out = (out_ / name).string(), .log = log, .is_only_one = false};
    set_options(arguments_, settings, &run);
    ProgressLine line(true);
    run.on_progress = [&line](const ReplayProgress& progress) {
      line.update(progress.frames, progress.total, [&] {
        return "    " + describe_progress(progress.frames, progress.total, line.seconds()) + "; " + progress.state();
      });
    };
    MeasuredRun measured;
    measured.outcome = run_replay(run);
    line.erase();
    fail_if(measured.outcome.written);
    measured.evaluation = value_or_fail(evaluate_folder(run.out, truth().string()));
    const RunEvaluation& evaluation = measured.evaluation;
    fail_if(plot_evaluation(evaluation.run, evaluation.truth, (out_ / name / "evaluation.png").string()));
    return measured;
  }

  void draw(const MeasuredRun& whole) {
    if (!whole.outcome.windows.empty()) {
      const WindowScene window = value_or_fail(read_window_scene(log().string(), 0));
      fail_if(viewer_offscreen::write_png(draw_window(window), (out_ / "rumi" / "window.png").string()));
    }
    WholeFile report((out_ / "rumi" / "report.html").string());
    report.write(make_report((out_ / "rumi").string(), {.groundtruth = truth().string()}));
    fail_if(report.commit());
  }

  void tell_files() const {
    fmt::print("\n");
    const auto file = [&](const char* what, const fs::path& path) {
      if (fs::exists(path)) fmt::print("{:<44}{}\n", what, path.string());
    };
    const fs::path rumi = out_ / "rumi";
    file("the map and the path, front and back", rumi / "trajectory.png");
    file("  the same of the front alone", out_ / "front_alone" / "trajectory.png");
    file("which images were rebuilt, and why", rumi / "window.png");
    file("the error", rumi / "evaluation.png");
    file("all of it as a page, for a browser", rumi / "report.html");
    file("trajectory (TUM format)", rumi / "trajectory.txt");
    file("map", rumi / "map.db");
    file("  for MeshLab or CloudCompare", rumi / "map.ply");
    file("all messages, for lcm-logplayer", log());
    file("the images, with their truth", sequence());
  }

  const Arguments& arguments_;
  fs::path out_;
  int step_ = 0;
};

void demo(const Arguments& arguments) {
  ReplayRun unused;
  refuse_if(arguments.synth.check());
  set_options(arguments, {}, &unused);
  start_logging("rumi", arguments.verbose, !arguments.verbose);
  Demo(arguments).run();
}

}  // namespace

void add_demo_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  arguments->synth.walk = synth::WalkKind::kNextRoom;
  arguments->synth.seconds = 20;
  arguments->synth.rate_hz = 20;
  CommandLine* command = app.add_command("demo", kSummary);
  command->add_option("-o,--output", arguments->out, "folder: new, empty, or of an earlier demo")
      ->type_name("FOLDER")
      .show_default();
  command->add_option("--seed", arguments->synth.seed, "number that chooses the building and the walk")->show_default();
  command->add_option("--seconds", arguments->synth.seconds, "length of the walk, s")->show_default();
  add_option_flags(command, arguments.get());
  command->add_flag("-v,--verbose", arguments->verbose, "log what the components do");
  run_if_chosen(command, chosen, arguments, demo);
}

}  // namespace rumi::tool
