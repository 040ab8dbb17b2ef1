// SPDX-License-Identifier: BSD-3-Clause
// rumi snapshot -o OUT: writes what a live system has so far, in the same files as `rumi replay`.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/running/failures.h"
#include "camera_driver/open_source.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/outputs/landmark_colours.h"
#include "rumi/outputs/map_file.h"
#include "rumi/outputs/masks.h"
#include "rumi/outputs/output_folder.h"
#include "rumi/outputs/run_picture.h"
#include "rumi/outputs/run_record.h"
#include "rumi/outputs/run_summary.h"
#include "rumi/outputs/snapshot.h"
#include "rumi/run/all_options.h"

namespace rumi::tool {
namespace {

struct Arguments : BusFlags {
  std::string out;
  double timeout_s = 10;
  bool update = false, quiet = false;
  uint64_t since_us = 0;
  std::string images;
  OptionFlags flags;  // only --config: how the recording of --images is played
  AllOptions options;
};

constexpr double kListenS = 1.5;  // every process publishes its status once a second

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

// Returns how many images reached front_tracker. The map lacks those for which it had no time. Absent if its status is
// unknown.
std::optional<int64_t> images_of(const nlohmann::ordered_json& processes) {
  const nlohmann::ordered_json::json_pointer received("/front_tracker/channels/CAMERA/received");
  if (!processes.contains(received)) return std::nullopt;
  return processes[received].get<int64_t>();
}

// Returns the largest number that a session of earlier runs can have. A session is named by the time of its first
// image, so those that began after the first of the running processes belong to this run.
int64_t last_session_before(const Arguments& arguments, const Snapshot& snapshot) {
  if (arguments.since_us > 0) return static_cast<int64_t>(arguments.since_us) - 1;
  int64_t began_us = map_server::kNoSession + 1;
  for (const auto& [name, status] : snapshot.processes)
    if (began_us == map_server::kNoSession + 1 || status.started_utime < began_us) began_us = status.started_utime;
  return began_us - 1;
}

nlohmann::ordered_json run_record(const Arguments& arguments, const AtlasCounts& counts, const RunMasks& masks,
                                  const nlohmann::ordered_json& processes) {
  nlohmann::ordered_json run{{"finished", true}, {"command", "snapshot"}, {"lcm_url", arguments.lcm_url}};
  run["masks"] = masks_to_json(masks);
  run["counts"] = counts_to_json(counts);
  run["processes"] = processes;
  if (const auto images = images_of(processes)) run["images"] = *images;
  run["cpu_ms_per_frame"] = nlohmann::ordered_json::object();
  for (const auto& [name, status] : processes.items()) {
    if (counts.frames == 0 || !status.contains("cpu_s")) continue;
    run["cpu_ms_per_frame"][name] = status["cpu_s"].get<double>() * 1e3 / static_cast<double>(counts.frames);
  }
  return run;
}

// Returns the status of each process as heard now. With --update, a process that has ended keeps the status of the
// earlier snapshot.
nlohmann::ordered_json known_processes(const Arguments& arguments, const Snapshot& snapshot) {
  nlohmann::ordered_json processes = nlohmann::ordered_json::object();
  if (arguments.update) {
    const nlohmann::ordered_json earlier = read_run_json(arguments.out);
    if (earlier.contains("processes")) processes = earlier["processes"];
  }
  for (const auto& [name, status] : snapshot.processes) processes[name] = to_json(status);
  return processes;
}

// Says how many images were dropped and so are in no file of the run; empty if none were.
std::string describe_dropped(const nlohmann::ordered_json& processes) {
  int64_t count = 0;
  for (const char* kind : {"dropped", "undecodable"}) {
    const nlohmann::ordered_json::json_pointer pointer(std::string("/front_tracker/channels/CAMERA/") + kind);
    if (processes.contains(pointer)) count += processes[pointer].get<int64_t>();
  }
  if (count == 0) return {};
  return fmt::format("of the {} images that came {} were dropped or refused by front_tracker, which says why",
                     images_of(processes).value_or(0), count);
}

void print_processes(const nlohmann::ordered_json& processes) {
  fmt::print("{:<18}{:>10}{:>9}{:>13}{:>8}{:>9}\n", "process", "received", "dropped", "undecodable", "CPU %", "MB");
  for (const auto& [name, status] : processes.items()) {
    int64_t received = 0, dropped = 0, undecodable = 0;
    for (const auto& [channel, counts] : status["channels"].items()) {
      received += counts["received"].get<int64_t>();
      dropped += counts["dropped"].get<int64_t>();
      undecodable += counts["undecodable"].get<int64_t>();
    }
    const double running_s = std::max(1e-3, status["running_s"].get<double>());
    fmt::print("{:<18}{:>10}{:>9}{:>13}{:>8.1f}{:>9.1f}\n", name, received, dropped, undecodable,
               100 * status["cpu_s"].get<double>() / running_s, status["rss_mb"].get<double>());
  }
}

// Taken from the recording that the system plays, if --images names it.
struct OfRecording {
  map_server::LandmarkColours colours;  // empty if reading the images again would take long
  cv::Size image_size;
};

OfRecording look_at_recording(const Arguments& arguments, const map_server::Atlas& atlas,
                              std::vector<std::string>* missing) {
  OfRecording result;
  if (arguments.images.empty()) return result;
  const std::string thrown = thrown_by([&] {
    spdlog::set_level(spdlog::level::err);  // its warnings were logged when the system started
    const auto recording =
        value_or_fail(camera_driver::open_recording(arguments.images, arguments.options.camera_driver));
    result.image_size = {recording->camera().width, recording->camera().height};
    if (recording->plays_few_quickly()) result.colours = landmark_colours(atlas, *recording).colours;
  });
  if (!thrown.empty()) missing->push_back("colours of map.ply: " + thrown);
  return result;
}

void take_snapshot(Arguments& arguments) {
  OptionTable table;
  describe(table, arguments.options);
  load(table, arguments.flags);
  fail_if(check_output_folder(arguments.out));
  const std::unique_ptr<LcmBus> bus = open_bus(arguments);
  Result<Snapshot> requested = request_snapshot(*bus, arguments.timeout_s, kListenS);
  if (!requested) {
    std::error_code not_empty;
    std::filesystem::remove(arguments.out, not_empty);
  }
  const Snapshot snapshot = value_or_fail(std::move(requested));
  const nlohmann::ordered_json processes = known_processes(arguments, snapshot);
  std::string copy_problem;
  const map_server::Atlas atlas =
      load_map_bytes(snapshot.database, (std::filesystem::path(arguments.out) / "map.db").string(), &copy_problem);
  const int64_t before = last_session_before(arguments, snapshot);
  const AtlasCounts counts = count(atlas, before);
  std::vector<std::string> missing;
  const OfRecording seen = look_at_recording(arguments, atlas, &missing);
  for (const std::string& problem : write_run_outputs(atlas, arguments.out, before, seen.colours, seen.image_size))
    missing.push_back(problem);
  const std::string no_picture = copy_problem.empty() ? draw_run_picture(arguments.out).error_text() : copy_problem;
  if (!no_picture.empty()) missing.push_back(no_picture);
  const RunMasks masks = masks_of(atlas, before);
  nlohmann::ordered_json run = run_record(arguments, counts, masks, processes);
  const std::string all_missing = note_missing(missing, arguments.out, &run);
  fail_if(write_run_json(arguments.out, run));
  fail_if(all_missing);
  if (arguments.quiet) return;
  std::vector<std::string> not_in_it = left_out(atlas, before);
  if (const std::string dropped = describe_dropped(processes); !dropped.empty()) not_in_it.push_back(dropped);
  print_summary(counts, notes_of(counts, snapshot.localized_after_s, masks), not_in_it, arguments.out);
  print_processes(processes);
}

}  // namespace

void add_snapshot_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("snapshot", "Write what a live system has so far, as `rumi replay` would");
  command
      ->add_option("-o,--output", arguments->out,
                   "folder; one with files that would be overwritten is refused, unless an earlier run made them")
      ->required();
  add_bus_flags(command, arguments.get());
  command->add_option("--timeout", arguments->timeout_s, "wait so long for an answer, s")->positive()->show_default();
  command->add_flag("--update", arguments->update, "keep what an earlier snapshot knew of processes that have ended");
  command->add_flag("-q,--quiet", arguments->quiet, "say only what went wrong");
  command->add_option("--since", arguments->since_us,
                      "frames of sessions that began since then, in us since 1970; default: since the first of the "
                      "processes that run was started");
  command
      ->add_option("--images", arguments->images,
                   "the recording that the system plays: landmarks of map.ply get the colours of its images; with "
                   "--config of the system, where that says how it is played")
      ->type_name("RECORDING");
  command->add_option("--config", arguments->flags.config, "YAML file with the options of the system")
      ->type_name("FILE");
  run_if_chosen(command, chosen, arguments, take_snapshot);
}

}  // namespace rumi::tool
