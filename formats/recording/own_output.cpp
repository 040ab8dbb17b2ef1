// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/own_output.h"

#include <set>

#include "formats/recording/file_kind.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

constexpr size_t kBytes = 200;  // the first bytes of a file tell who wrote it

bool is_of_a_run(const fs::path& name) {
  static const std::set<std::string> kNames = {"run.json",    "trajectory.txt", "trajectory.png", "trajectory.mp4",
                                               "frames.csv",  "map.ply",        "windows.csv",    "evaluation.png",
                                               "report.html", "windows",        "submaps",        "pictures",
                                               "map.db.lock", "map.db"};
  return kNames.contains(name.filename().string());
}

bool is_output_folder(const fs::path& folder) {
  if (beginning_of(folder / "run.json", kBytes).find("\"program\": \"rumi\"") == std::string::npos) return false;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (!is_of_a_run(it->path())) return false;
  return !error;
}

}  // namespace

std::string advice_on_own_output(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error))
    return is_output_folder(path)
               ? "is the output folder of a run and no recording: give the recording that its run.json names (input); "
                 "`rumi export-map` writes its map for other programs"
               : "";
  if (!beginning_of(path, kBytes).starts_with("SQLite format 3")) return "";
  return "is a database and no recording: the map of a run (map.db) is written for other programs by `rumi "
         "export-map`, "
         "and drawn by `rumi view`; to find the place of a recording in it give the recording, with --set "
         "map_server.localize_only=true --set map_server.database=" +
         path.string();
}

}  // namespace rumi
