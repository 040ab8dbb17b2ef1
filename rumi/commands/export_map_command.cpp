// SPDX-License-Identifier: BSD-3-Clause
// rumi export-map MAP.db -o DIR --format F: a map for other programs.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "base/command_line.h"
#include "base/failures.h"
#include "map_server/outputs/colmap_export.h"
#include "map_server/outputs/writers.h"
#include "rumi/commands/commands.h"
#include "rumi/outputs/map_file.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string map, out, format;
};

std::string export_map(const map_server::Atlas& atlas, const std::string& out, const std::string& format) {
  if (format == "colmap-text") return map_server::write_colmap_text(atlas, out);
  if (format == "colmap-bin") return map_server::write_colmap_binary(atlas, out);
  std::error_code error;
  fs::create_directories(out, error);
  if (error) return fmt::format("{}: cannot be made: {}", out, error.message());
  if (format == "ply") return map_server::write_ply(atlas, (fs::path(out) / "map.ply").string());
  return map_server::write_trajectory_tum(atlas, (fs::path(out) / "trajectory.txt").string());
}

int run(const Arguments& arguments) {
  std::string error;
  try {
    error = export_map(load_map(arguments.map), arguments.out, arguments.format);
  } catch (const std::exception& e) {
    error = reason_of(e);
  }
  if (error.empty()) return 0;
  fmt::print(stderr, "rumi export-map: {}\n", error);
  return 1;
}

}  // namespace

void add_export_map_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("export-map", "Write a map for other programs");
  command->add_option("MAP", arguments->map, "map.db of a run, or that of a running map_server")->required();
  command->add_option("-o,--output", arguments->out, "folder, created if missing")->type_name("FOLDER").required();
  command
      ->add_option("--format", arguments->format,
                   "colmap-text or colmap-bin (cameras, images, points3D), ply (map.ply), tum (trajectory.txt)")
      ->required()
      ->one_of({"colmap-text", "colmap-bin", "ply", "tum"});
  command->on_chosen([arguments, chosen] { *chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace rumi::tool
