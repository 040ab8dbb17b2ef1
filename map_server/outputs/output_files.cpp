// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/outputs/output_files.h"

#include <fmt/format.h>

#include <filesystem>
#include <regex>
#include <set>

#include "map_server/outputs/frames_file.h"
#include "map_server/outputs/ply_file.h"

namespace rumi::map_server {
namespace {

namespace fs = std::filesystem;

Result<> remove_stale_submaps(const fs::path& folder, const std::set<std::string>& ours) {
  static const std::regex name(R"((s-?\d+-)?b?\d{3,}\.txt)");
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string file = entry.path().filename().string();
    if (ours.contains(file) || !std::regex_match(file, name)) continue;
    fs::remove(entry.path(), error);
    if (error) break;
  }
  if (error) return Error{fmt::format("cannot clear {}: {}", folder.string(), error.message())};
  return {};
}

Result<> write_submaps(const Atlas& atlas, const fs::path& folder, int64_t after) {
  std::set<std::string> written;
  for (const auto& [key, owner] : atlas.submaps()) {
    if (key.session <= after) continue;
    const std::string name = submap_file_name(atlas, key);
    if (const Result<> file = write_submap_tum(owner.submap, (folder / name).string()); !file) return file;
    written.insert(name);
  }
  return remove_stale_submaps(folder, written);
}

}  // namespace

std::vector<std::string> write_outputs(const Atlas& atlas, const std::string& folder, int64_t after,
                                       const LandmarkColours& colours) {
  const fs::path root(folder);
  std::error_code error;
  fs::create_directories(root / "submaps", error);
  if (error) return {fmt::format("cannot create {}: {}", (root / "submaps").string(), error.message())};
  // The small files that users want most come first, in case the disk is nearly full.
  std::vector<std::string> problems;
  for (const Result<>& written :
       {write_trajectory_tum(atlas, (root / "trajectory.txt").string(), after),
        write_frames_csv(atlas, (root / "frames.csv").string(), after), write_submaps(atlas, root / "submaps", after),
        write_ply(atlas, (root / "map.ply").string(), colours)})
    if (!written) problems.push_back(written.error().text());
  return problems;
}

}  // namespace rumi::map_server
