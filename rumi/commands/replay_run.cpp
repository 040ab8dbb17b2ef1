// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/commands/replay_run.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "base/files/whole_file.h"
#include "base/running/failures.h"
#include "base/running/log.h"
#include "base/this_process/cpu_clock.h"
#include "camera_driver/source/image_source.h"
#include "rumi/outputs/landmark_colours.h"
#include "rumi/outputs/masks.h"
#include "rumi/outputs/output_folder.h"
#include "rumi/outputs/reserved_space.h"
#include "rumi/outputs/run_picture.h"
#include "rumi/outputs/run_record.h"
#include "rumi/outputs/run_summary.h"
#include "rumi/run/load_over_time.h"
#include "rumi/run/metered_bus.h"
#include "rumi/run/why_no_map.h"
#include "ruminator/queue/spool.h"
#include "ruminator/window/window_message.h"

namespace rumi::tool {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::ordered_json;
namespace fs = std::filesystem;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;
}

// Writes the windows to OUT/windows, as files that `rumi ruminate` rebuilds, and their outcomes to OUT/windows.csv.
class WindowOutput {
 public:
  explicit WindowOutput(const std::string& out) : out_(out) {}

  // Removes the windows of an earlier run.
  Result<> prepare() {
    std::error_code error;
    fs::create_directories(out_ / "windows", error);
    for (fs::directory_iterator it(out_ / "windows", error), end; !error && it != end; it.increment(error))
      if (it->path().extension() == ".window") fs::remove(it->path(), error);
    if (error) return Error{error.message(), (out_ / "windows").string()};
    return {};
  }
  ReplayHooks hooks() {
    return {[this](const ruminator::WindowJob& job) {
              ++complete_;
              const std::string name = to_string(name_of(job.window)) + ".window";
              const Result<> written = ruminator::write_window_job((out_ / "windows" / name).string(), job);
              if (error_.empty()) error_ = written.error_text();
            },
            [this](const ruminator::RuminationWindow& window, const ruminator::BuildResult& result) {
              rows_.push_back(make_window_row(to_string(name_of(window)), window, result));
            }};
  }
  // Writes windows.csv. An Error if it or one of the windows could not be written.
  Result<> finish() {
    WholeFile csv((out_ / "windows.csv").string());
    csv.write(window_csv_header() + "\n");
    for (const WindowRow& row : rows_) csv.write(window_csv_line(row) + "\n");
    const Result<> written = csv.commit();
    if (!error_.empty()) return Error{error_};
    return written;
  }
  // Returns a line for each window that was not rebuilt.
  std::vector<std::string> failures() const {
    std::vector<std::string> lines;
    for (const WindowRow& row : rows_)
      if (!row.ok)
        lines.push_back(
            fmt::format("window {}, {}: {}", row.window.id, describe(row.window), row.result.submap.error_text()));
    return lines;
  }
  const std::vector<WindowRow>& rows() const { return rows_; }
  ordered_json counts() const {
    return {{"complete", complete_},
            {"rebuilt", std::count_if(rows_.begin(), rows_.end(), [](const WindowRow& row) { return row.ok; })}};
  }

 private:
  fs::path out_;
  int complete_ = 0;
  std::vector<WindowRow> rows_;
  std::string error_;  // for the first window that could not be written; empty if all were written
};

// Returns the content of run.json. Only cpu_ms_per_frame, cpu_ms_per_frame_by_stage, cpu_s, wall_s, peak_rss_mb and
// load differ between two runs of the same input.
ordered_json run_record(const ReplayRun& what, Replay& replay, const WindowOutput& windows, bool stopped,
                        double run_cpu_s, double wall_s, const LoadOverTime& load) {
  const int64_t frames = replay.progress().frames;
  ordered_json run{{"finished", true},
                   {"command", "replay"},
                   {"input", what.input},
                   {"options", options_to_json(what.options_yaml)},
                   {"images", frames}};
  if (stopped) run["stopped_early"] = true;
  const camera_driver::SkippedFrames skipped = replay.skipped();
  run["skipped_images"] = {{"malformed", skipped.malformed},       {"duplicate", skipped.duplicate},
                           {"out_of_order", skipped.out_of_order}, {"unreadable", skipped.unreadable},
                           {"wrong_size", skipped.wrong_size},     {"other_camera", skipped.other_camera},
                           {"repeated", skipped.repeated}};
  run["masks"] = masks_to_json(masks_of(replay.atlas(), replay.earlier_sessions()));
  run["counts"] = counts_to_json(count(replay.atlas(), replay.earlier_sessions()));
  if (const auto after_s = replay.localized_after_s()) run["localized_after_s"] = *after_s;
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
  run["cpu_ms_per_frame_by_stage"] = ordered_json::object();
  for (const auto& [name, stages] : replay.cpu_s_by_stage())
    for (const auto& [stage, cpu_s] : stages)
      if (frames > 0) run["cpu_ms_per_frame_by_stage"][name][stage] = cpu_s * 1e3 / static_cast<double>(frames);
  run["cpu_s"] = run_cpu_s;
  run["wall_s"] = wall_s;
  run["load"] = load.to_json();
  if (what.is_only_one) run["peak_rss_mb"] = peak_rss_mb();
  return run;
}

// Writes all outputs that can be written, also windows.csv and the end of --log. Returns a line for each failure.
std::vector<std::string> write_everything(Replay& replay, WindowOutput& windows, const ReplayRun& run) {
  const std::string& out = run.out;
  std::vector<std::string> missing = {replay.close_log().error_text(), windows.finish().error_text()};
  // map.db comes first, because all other outputs can be made from it.
  const std::string no_map = replay.store().write_copy((fs::path(out) / "map.db").string()).error_text();
  missing.push_back(no_map);
  map_server::LandmarkColours colours;
  if (run.colours_of_videos || replay.recording().plays_few_quickly()) {
    const std::string thrown =
        thrown_by([&] { colours = landmark_colours(replay.atlas(), replay.recording()).colours; });
    if (!thrown.empty()) missing.push_back("colours of map.ply: " + thrown);
  }
  const Camera& camera = replay.recording().camera();
  for (const std::string& problem :
       write_run_outputs(replay.atlas(), out, replay.earlier_sessions(), colours, {camera.width, camera.height}))
    missing.push_back(problem);
  if (no_map.empty()) missing.push_back(draw_run_picture(out).error_text());
  std::erase(missing, "");
  return missing;
}

// Reserves disk space for the outputs. If that fails, removes the folder again if it is empty.
Result<> reserve_outputs(const std::string& out, int64_t images, ReservedSpace* reserved) {
  const std::string doubt = doubt_about_space(out, images);
  const Result<> taken = reserved->take(out, images);
  std::error_code not_empty;
  if (!taken) fs::remove(out, not_empty);
  if (taken && !doubt.empty()) log_warning("{}", doubt);
  return taken;
}

Result<> check_log(const ReplayRun& run) {
  if (run.log.empty()) return {};
  std::error_code none;
  if (fs::equivalent(run.log, run.input, none)) return Error{fmt::format("--log {} is the input itself", run.log)};
  // The log of an earlier run is replaced; any other file of this name is not.
  if (fs::is_regular_file(run.log, none) && fs::file_size(run.log, none) > 0 && !is_lcm_log(run.log))
    return Error{"exists and is no lcm log", "--log " + run.log, "remove it or give another name"};
  return {};
}

// Plays the input to its end, or until the run is stopped, and lets the components finish.
void play(const ReplayRun& run, Replay* replay, ReplayOutcome* outcome, LoadOverTime* load) {
  const auto asked_to_stop = [&run] { return run.stop && *run.stop; };
  while (!asked_to_stop() && replay->step()) {
    const ReplayProgress progress = replay->progress();
    if (progress.frames == 1) outcome->begin_us = progress.utime_us;
    if (progress.frames > 0) load->note(progress.utime_us, replay->cpu_s());
    if (run.on_progress) run.on_progress(progress);
  }
  if (const std::string unfinished = replay->finish(); !unfinished.empty())
    outcome->warning = "not everything could be handed on at the end: " + unfinished;
  outcome->stopped = asked_to_stop();
}

std::vector<std::string> what_is_left_out(Replay& replay, const WindowOutput& windows) {
  std::vector<std::string> lines = left_out(replay.atlas(), replay.earlier_sessions());
  for (const std::string& line : windows.failures()) lines.push_back(line);
  for (const std::string& line : replay.broken()) lines.push_back(line);
  if (const camera_driver::SkippedFrames skipped = replay.skipped(); skipped.total() > 0)
    lines.push_back("of the recording: " + skipped.to_string());
  return lines;
}

// Returns why no image has a pose in the map (with localize_only: in the map to localize in); empty if one has.
std::string why_no_pose(const ReplayRun& run, const ReplayOutcome& outcome) {
  const map_server::MapServerOptions& options = run.options.map_server;
  if (outcome.counts.frames_in_map > 0) return {};
  if (options.localize_only && outcome.counts.tracked_frames > 0)
    return fmt::format("not localized: nothing in this recording looks like {}", options.database);
  return why_no_map(run.input, run.options.camera_driver);
}

// Returns a complaint if the map lacks many images; empty if it has nearly all or none of them, or if the user did not
// want submaps to be joined.
std::string why_not_whole(const ReplayRun& run, const ReplayOutcome& outcome) {
  constexpr double kWhole = 0.9;
  if (!run.options.map_server.merge.enabled || !run.options.ruminator.rebuild) return {};
  const AtlasCounts& counts = outcome.counts;
  if (counts.frames_in_map == 0 ||
      static_cast<double>(counts.frames_in_map) >= kWhole * static_cast<double>(counts.frames))
    return {};
  return fmt::format("the map has a pose for {} of {} images only; what is left out, and why, is said above",
                     counts.frames_in_map, counts.frames);
}

// Prepares all outputs before anything is played. An Error if they could not be written.
Result<> prepare(const ReplayRun& run, Replay* replay, WindowOutput* windows, ReservedSpace* reserved) {
  Result<> ready = check_log(run);
  if (ready) ready = check_mask_stays(run.options.camera_driver.mask, run.input, run.out);
  if (ready) ready = check_output_folder(run.out);
  if (ready) ready = reserve_outputs(run.out, replay->progress().total, reserved);
  if (ready) ready = prepare_output_folder(run.out);
  if (ready && !run.log.empty()) ready = replay->record(run.log);
  if (ready) ready = windows->prepare();
  return ready;
}

// Fills the part of the outcome that tells the user what the run produced and what is missing.
void describe_result(const ReplayRun& run, Replay& replay, const WindowOutput& windows, ReplayOutcome* outcome) {
  outcome->counts = count(replay.atlas(), replay.earlier_sessions());
  outcome->notes = notes_of(outcome->counts, replay.localized_after_s().value_or(-1),
                            masks_of(replay.atlas(), replay.earlier_sessions()));
  outcome->left_out = what_is_left_out(replay, windows);
  outcome->windows = windows.rows();
  outcome->images = replay.progress().frames;
  outcome->total = replay.progress().total;
  outcome->complaints = replay.skipped().complaints(replay.decoded());
  if (const std::string& doubt = replay.calibration_doubt(); !doubt.empty()) outcome->complaints.push_back(doubt);
  if (outcome->stopped) return;  // a part of a recording need not make a whole map
  if (const std::string why = why_no_pose(run, *outcome); !why.empty()) outcome->complaints.push_back(why);
  if (const std::string why = why_not_whole(run, *outcome); !why.empty()) outcome->complaints.push_back(why);
}

}  // namespace

ReplayOutcome run_replay(const ReplayRun& run) {
  ReplayOutcome outcome;
  const auto begin = Clock::now();
  const double begin_cpu_s = process_cpu_s();
  WindowOutput windows(run.out);
  AllOptions options = run.options;
  options.viewer_offscreen.output = run.out;
  options.ruminator.scratch = run.out;
  ReplayHooks hooks = windows.hooks();
  hooks.stop = run.stop;
  Replay replay(options, run.input, hooks);
  ReservedSpace reserved;
  outcome.written = prepare(run, &replay, &windows, &reserved);
  if (outcome.written) {
    LoadOverTime load;
    play(run, &replay, &outcome, &load);
    reserved.release();
    const std::vector<std::string> missing = write_everything(replay, windows, run);
    outcome.wall_s = seconds_since(begin);
    ordered_json record =
        run_record(run, replay, windows, outcome.stopped, process_cpu_s() - begin_cpu_s, outcome.wall_s, load);
    const std::string all_missing = note_missing(missing, run.out, &record);
    outcome.written = write_run_json(run.out, record);
    if (outcome.written && !all_missing.empty()) outcome.written = Error{all_missing};
  }
  describe_result(run, replay, windows, &outcome);
  return outcome;
}

}  // namespace rumi::tool
