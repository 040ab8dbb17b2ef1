// SPDX-License-Identifier: BSD-3-Clause
// rumi export-map MAP -o DIR --format F: a map for other programs.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <vector>

#include "base/command_line.h"
#include "base/failures.h"
#include "base/log.h"
#include "base/options.h"
#include "camera_driver/flags.h"
#include "camera_driver/open_source.h"
#include "map_server/outputs/colmap_export.h"
#include "map_server/outputs/writers.h"
#include "rumi/commands/commands.h"
#include "rumi/outputs/landmark_colours.h"
#include "rumi/outputs/map_file.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string map, out, format, images;
  std::vector<std::string> settings;
  camera_driver::CameraOptions camera;
};

std::string export_map(const map_server::Atlas& atlas, const map_server::LandmarkColours& colours,
                       const std::string& out, const std::string& format) {
  if (format == "colmap-text") return map_server::write_colmap_text(atlas, out, colours);
  if (format == "colmap-bin") return map_server::write_colmap_binary(atlas, out, colours);
  std::error_code error;
  fs::create_directories(out, error);
  if (error) return fmt::format("{}: cannot be made: {}", out, error.message());
  if (format == "ply") return map_server::write_ply(atlas, (fs::path(out) / "map.ply").string(), colours);
  return map_server::write_trajectory_tum(atlas, (fs::path(out) / "trajectory.txt").string());
}

// Throws what is wrong with the recording.
map_server::LandmarkColours colours_from(const Arguments& arguments, const map_server::Atlas& atlas) {
  start_logging("rumi", false, false);
  const camera_driver::OpenedSource recording = camera_driver::open_recording(arguments.images, arguments.camera);
  if (!recording.ok()) throw std::runtime_error(recording.error);
  const SeenColours seen = landmark_colours(atlas, *recording.source);
  if (seen.seen == 0 && seen.keyframes > 0)
    throw std::runtime_error(
        fmt::format("{}: has none of the {} images that {} was made of: is it of another recording, or of other times "
                    "(--rate)?",
                    arguments.images, seen.keyframes, arguments.map));
  fmt::print(
      "{}: {} of the {} images of keyframes; landmarks that none of them shows have the colour of their submap\n",
      arguments.images, seen.seen, seen.keyframes);
  return seen.colours;
}

std::string wrong_options(Arguments& arguments) {
  OptionTable table;
  describe(table, arguments.camera);
  std::string problem = load_options(table, "", arguments.settings);
  if (problem.empty()) problem = check(arguments.camera);
  if (problem.empty() && !arguments.images.empty() && arguments.format == "tum")
    problem = "--images gives landmarks their colours, and --format tum has none: leave it out";
  if (problem.empty() && arguments.images.empty() && !arguments.settings.empty())
    problem = "there are no --images that the flags of the recording could be for: leave them out";
  return problem;
}

int run(Arguments& arguments) {
  std::string error = wrong_options(arguments);
  const bool are_wrong = !error.empty();
  try {
    if (error.empty()) {
      const map_server::Atlas atlas = load_map(map_database_at(arguments.map));
      map_server::LandmarkColours colours;
      if (!arguments.images.empty()) colours = colours_from(arguments, atlas);
      error = export_map(atlas, colours, arguments.out, arguments.format);
    }
  } catch (const std::exception& e) {
    error = reason_of(e);
  }
  if (error.empty()) {
    fmt::print("{} written to {}\n", arguments.format, arguments.out);
    return 0;
  }
  fmt::print(stderr, "rumi export-map: {}\n", error);
  return are_wrong ? 2 : 1;
}

}  // namespace

void add_export_map_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command =
      app.add_command("export-map", "Write a map for other programs: COLMAP, MeshLab (a recording: `rumi export`)");
  command->add_option("MAP", arguments->map, "output folder of a run, or map.db of one or of a running map_server")
      ->required();
  command->add_option("-o,--output", arguments->out, "folder, created if missing")->type_name("FOLDER").required();
  command
      ->add_option("--format", arguments->format,
                   "colmap-text or colmap-bin (cameras, images, points3D), ply (map.ply), tum (trajectory.txt)")
      ->required()
      ->one_of({"colmap-text", "colmap-bin", "ply", "tum"});
  command
      ->add_option("--images", arguments->images,
                   "the recording that the map was made of: landmarks get the colours of its images (without: a colour "
                   "for each submap); where it was played with --rate, give that again, with --every and --start")
      ->type_name("RECORDING");
  camera_driver::add_flags(*command, {"--camera", "--every", "--start", "--rate", "--log-channel"},
                           &arguments->settings);
  command->on_chosen([arguments, chosen] { *chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace rumi::tool
