// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/recordings/truth_of_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "camera_driver/source/camera_options.h"
#include "formats/bag/bag_file.h"
#include "formats/bag/bag_poses.h"
#include "formats/recording/dataset_folder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

constexpr double kRateOfIcl_hz = 30;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// Returns the truth of ICL-NUIM in the folder; empty if there is no such file, or if there are several.
fs::path truth_of_icl(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code))
    if (it->path().filename().string().ends_with(kEndingOfIclNuim)) files.push_back(it->path());
  return files.size() == 1 ? files.front() : fs::path();
}

// Returns the names that a truth may have in the folder, the preferred one first. EuRoC's state estimate is preferred
// to a tracking system's path of a marker (TUM-VI's mocap0).
std::vector<fs::path> names_in(const fs::path& folder) {
  std::vector<fs::path> names = {folder / "groundtruth.txt"};
  for (const char* mav : {"mav0", ""})
    for (const char* sensor : {"state_groundtruth_estimate0", "mocap0"})
      names.push_back(folder / mav / sensor / "data.csv");
  return names;
}

FoundTruth look_in(const std::vector<fs::path>& files, const std::vector<fs::path>& folders) {
  for (const fs::path& file : files)
    if (is_file(file)) return {file.string(), 0, ""};
  for (const fs::path& folder : folders) {
    for (const fs::path& file : names_in(folder))
      if (is_file(file)) return {file.string(), 0, ""};
    if (const fs::path icl = truth_of_icl(folder); !icl.empty()) return {icl.string(), kRateOfIcl_hz, ""};
  }
  return {};
}

// True if the folder is inside the folder of one recording: mav0, cam0, data, rgb. Other folders may hold several
// recordings, and a truth beside these belongs to none of them.
bool is_part_of_dataset(const fs::path& folder) {
  const std::string name = folder.filename().string();
  return name == "mav0" || name == "cam0" || name == "data" || name == "rgb";
}

std::vector<fs::path> folders_of(const fs::path& recording) {
  std::vector<fs::path> folders = {recording, find_dataset(recording).folder};
  constexpr int kDeepest = 3;  // levels of folders in mav0/cam0/data
  for (int i = 0; i < kDeepest && is_part_of_dataset(folders.back()); ++i)
    folders.push_back(folders.back().parent_path());
  return folders;
}

}  // namespace

FoundTruth find_truth(const std::string& recording) {
  std::error_code code;
  const fs::path path = (fs::path(recording) / "").parent_path();  // without a slash at its end
  if (!fs::exists(path, code)) return {"", 0, fmt::format("the recording {} is no longer there", recording)};
  const bool is_folder = fs::is_directory(path, code);
  const fs::path beside = path.parent_path() / (path.stem().string() + "-groundtruth.txt");
  FoundTruth found = is_folder ? look_in({}, folders_of(path)) : look_in({beside}, {path.parent_path()});
  if (found.file.empty() && kind_of_bag(recording) != BagKind::kNone) found.file = recording;
  if (found.file.empty())
    found.error =
        fmt::format("there is no truth beside {} (groundtruth.txt, mav0/state_groundtruth_estimate0/data.csv, *{})",
                    recording, kEndingOfIclNuim);
  return found;
}

TruthFile read_truth(const std::string& file, const TruthOptions& options) {
  if (kind_of_bag(file) == BagKind::kNone) return read_groundtruth(file, options);
  BagPoses bag = poses_in_bag(file, camera_driver::CameraOptions{}.log_channel);
  TruthFile truth;
  truth.error = bag.error;
  if (!truth.error.empty()) truth.error += "; give its true path as a file of poses, as groundtruth.txt of TUM";
  if (!bag.note.empty()) truth.notes.push_back(bag.note);
  for (const auto& [utime_us, map_from_cam] : bag.poses) truth.poses.push_back({utime_us, map_from_cam});
  return truth;
}

}  // namespace rumi::tool
