// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/bag_file.h"

#include <filesystem>

#include "formats/recording/file_kind.h"
#include "formats/recording/recording_parts.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

BagKind kind_of_file(const fs::path& file) {
  const std::string beginning = beginning_of(file, 32), extension = lower_extension(file);
  if (beginning.starts_with("#ROSBAG") || beginning.starts_with("#ROSRECORD")) return BagKind::kRos1;
  if (beginning.starts_with("\x89MCAP")) return BagKind::kMcap;
  // SQLite files of other programs begin in the same way.
  if (extension == ".db3") return BagKind::kSqlite;
  if (extension == ".bag") return BagKind::kRos1;
  return extension == ".mcap" ? BagKind::kMcap : BagKind::kNone;
}

}  // namespace

bool BagConnection::has_images() const { return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage"; }

bool BagConnection::has_calibration() const { return type == "sensor_msgs/CameraInfo"; }

bool BagConnection::has_transforms() const { return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage"; }

std::string type_named(const std::string& name) {
  const size_t slash = name.find("/msg/");
  return slash == std::string::npos ? name : name.substr(0, slash) + name.substr(slash + 4);
}

BagKind kind_of_bag(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return kind_of_file(path);
  const std::string metadata = beginning_of(fs::path(path) / "metadata.yaml", 1000);
  if (metadata.find("rosbag2_bagfile_information") != std::string::npos) return BagKind::kFolder;
  const std::vector<fs::path> parts = parts_in(path);
  const bool are_bags = !parts.empty() && kind_of_file(parts.front()) != BagKind::kNone;
  return are_bags ? BagKind::kFolder : BagKind::kNone;
}

std::unique_ptr<BagFile> open_bag_file(const std::string& path) {
  switch (kind_of_bag(path)) {
    case BagKind::kMcap:
      return open_mcap_file(path);
    case BagKind::kSqlite:
      return open_ros2_sqlite(path);
    case BagKind::kFolder:
      return open_bag_folder(path);
    default:
      return open_ros1_bag(path);
  }
}

std::optional<int64_t> first_recorded_in_bag(const fs::path& file) {
  std::optional<int64_t> first_us;
  open_bag_file(file.string())->scan([&first_us](const BagMessage& message) {
    first_us = message.time_ns / 1000;
    return false;
  });
  return first_us;
}

}  // namespace rumi
