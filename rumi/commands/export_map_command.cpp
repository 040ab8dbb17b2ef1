// SPDX-License-Identifier: BSD-3-Clause
// rumi export-map MAP -o DIR --format F: writes a map for other programs.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "base/command_line/options.h"
#include "base/running/log.h"
#include "camera_driver/flags.h"
#include "camera_driver/open_source.h"
#include "map_server/outputs/colmap_export.h"
#include "map_server/outputs/ply_file.h"
#include "map_server/outputs/trajectory_file.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/outputs/colmap_images.h"
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

Result<> write_map(const map_server::Atlas& atlas, const map_server::LandmarkColours& colours,
                   const map_server::ImageFiles& files, const std::string& out, const std::string& format) {
  if (format == "colmap-text") return map_server::write_colmap_text(atlas, out, colours, files);
  if (format == "colmap-bin") return map_server::write_colmap_binary(atlas, out, colours, files);
  std::error_code error;
  fs::create_directories(out, error);
  if (error) return Error{"cannot be made: " + error.message(), out};
  if (format == "ply") return map_server::write_ply(atlas, (fs::path(out) / "map.ply").string(), colours);
  return map_server::write_trajectory_tum(atlas, (fs::path(out) / "trajectory.txt").string());
}

map_server::LandmarkColours colours_from(const Arguments& arguments, const map_server::Atlas& atlas,
                                         camera_driver::ImageSource& recording) {
  const SeenColours seen = landmark_colours(atlas, recording);
  if (seen.seen == 0 && seen.keyframes > 0)
    fail_if(
        fmt::format("{}: has none of the {} images that {} was made of: is it of another recording, or of other times "
                    "(--rate)?",
                    arguments.images, seen.keyframes, arguments.map));
  fmt::print(
      "{}: {} of the {} images of keyframes; landmarks that none of them shows have the colour of their submap\n",
      arguments.images, seen.seen, seen.keyframes);
  return seen.colours;
}

// Returns the files of the keyframes' images, and prints the folder in which COLMAP finds them.
map_server::ImageFiles files_from(const Arguments& arguments, const map_server::Atlas& atlas,
                                  camera_driver::ImageSource& recording) {
  const ColmapImages images = find_colmap_images(atlas, recording, arguments.out);
  fmt::print("{} {}: for COLMAP --image_path {}\n",
             images.are_written ? "the recording has no files of images: those of the keyframes were written into"
                                : "images are named by their files in",
             images.folder, images.folder);
  if (const int64_t seen = static_cast<int64_t>(images.files.size()); seen < images.keyframes)
    complain("export-map", fmt::format("{} of the {} images of the map are not in {}: their names are their times",
                                       images.keyframes - seen, images.keyframes, arguments.images));
  return images.files;
}

// Sets and checks the options. Throws WrongOptions.
void read_options(Arguments& arguments) {
  OptionTable table;
  describe(table, arguments.camera);
  refuse_if(load_options(table, "", arguments.settings));
  refuse_if(check(arguments.camera));
  if (!arguments.images.empty() && arguments.format == "tum")
    refuse_if("--images gives landmarks their colours, and --format tum has none: leave it out");
  if (arguments.images.empty() && !arguments.settings.empty())
    refuse_if("there are no --images that the flags of the recording could be for: leave them out");
}

void export_map(Arguments& arguments) {
  read_options(arguments);
  const map_server::Atlas atlas = load_map(map_database_at(arguments.map));
  const bool for_colmap = arguments.format.starts_with("colmap");
  map_server::LandmarkColours colours;
  map_server::ImageFiles files;
  if (!arguments.images.empty()) {
    start_logging("rumi", false, false);
    const auto recording = value_or_fail(camera_driver::open_recording(arguments.images, arguments.camera));
    colours = colours_from(arguments, atlas, *recording);
    if (for_colmap) files = files_from(arguments, atlas, *recording);
  }
  fail_if(write_map(atlas, colours, files, arguments.out, arguments.format));
  fmt::print("{} written to {}\n", arguments.format, arguments.out);
  if (for_colmap && arguments.images.empty())
    fmt::print(
        "the names of images are their times, and no files: with --images RECORDING they are those that COLMAP "
        "finds\n");
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
      ->add_option(
          "--images", arguments->images,
          "the recording that the map was made of: landmarks get the colours of its images (without: a colour "
          "for each submap), and COLMAP's images the names of its files (of a video, log or bag they are "
          "written into FOLDER/images); where it was played with --rate, give that again, with --every and --start")
      ->type_name("RECORDING");
  camera_driver::add_flags(*command, {"--camera", "--every", "--start", "--rate", "--log-channel"},
                           &arguments->settings);
  run_if_chosen(command, chosen, arguments, export_map);
}

}  // namespace rumi::tool
