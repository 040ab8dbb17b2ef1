// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/foreign_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>

namespace rumi::camera_driver {
namespace {

namespace fs = std::filesystem;

std::string beginning_of(const fs::path& file, size_t bytes) {
  std::string text(bytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(text.data(), static_cast<std::streamsize>(bytes));
  text.resize(static_cast<size_t>(std::max<std::streamsize>(0, in.gcount())));
  return text;
}

std::string extension_of(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string advice_on_ros(const std::string& what, const std::string& with_ros) {
  return fmt::format(
      "is {}, which is not read. Write the images of one topic into a folder, each with its time in nanoseconds as its "
      "name (the Python package `rosbags` reads it without ROS), or take images or a video with ROS ({}; --rate HZ, "
      "where "
      "these have no times), and give that, with --camera FILE",
      what, with_ros);
}

std::string advice_on_ros1() {
  return advice_on_ros("a ROS 1 bag", "`rosrun image_view extract_images image:=/TOPIC` while `rosbag play` runs");
}

std::string advice_on_ros2(const std::string& what) {
  return advice_on_ros(what,
                       "`ros2 run image_view video_recorder --ros-args -r image:=/TOPIC` while `ros2 bag play` runs");
}

constexpr const char* kAdviceOnMaps =
    "the map of a run (map.db) is written for other programs by `rumi export-map`, and drawn by `rumi view`";

// It may be beside a recording, in its folder.
bool is_output_folder(const fs::path& folder) {
  std::error_code ignored;
  const auto has = [&](const char* name) { return fs::exists(folder / name, ignored); };
  return has("run.json") && has("map.db") && !has("rgb.txt") && !has("mav0") && !has("data.csv") &&
         !has("calibration.yaml");
}

// By the beginnings of the files, whatever their names are.
std::string advice_on_file(const fs::path& file) {
  using namespace std::string_literals;
  const std::string beginning = beginning_of(file, 16), extension = extension_of(file);
  if (beginning.starts_with("#ROSBAG") || (extension == ".bag" && beginning.starts_with("#ROSRECORD")))
    return advice_on_ros1();
  if (beginning.starts_with("\x89MCAP")) return advice_on_ros2("an MCAP file (a ROS 2 bag)");
  if (extension == ".db3" || (extension == ".sqlite3" && beginning == "SQLite format 3\0"s))
    return advice_on_ros2("a ROS 2 bag (SQLite)");
  if (beginning == "SQLite format 3\0"s) return fmt::format("is a database and no recording; {}", kAdviceOnMaps);
  if (extension == ".bag") return advice_on_ros1();
  if (extension == ".mcap") return advice_on_ros2("an MCAP file (a ROS 2 bag)");
  struct Other {
    const char *extension, *what, *how;
  };
  constexpr std::array kOthers = {
      Other{".svo", "a recording of a ZED camera", "ZED's SDK writes the left images or a video (svo_export)"},
      Other{".svo2", "a recording of a ZED camera", "ZED's SDK writes the left images or a video (svo_export)"},
      Other{".klg", "a Kinect log (Logger2)", "write its colour images into a folder, with their times as names"},
      Other{".oni", "a recording of OpenNI", "write its colour images into a folder, with their times as names"},
      Other{".vrs", "a VRS file", "`vrs extract-images` writes its images"},
  };
  for (const Other& other : kOthers)
    if (extension == other.extension)
      return fmt::format("is {}, which is not read: {}; give that folder or video, with --camera FILE", other.what,
                         other.how);
  return {};
}

}  // namespace

std::string advice_on_foreign_recording(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return advice_on_file(path);
  if (is_output_folder(path)) return fmt::format("is the output folder of a run and no recording; {}", kAdviceOnMaps);
  const std::string metadata = beginning_of(path / "metadata.yaml", 1000);
  return metadata.find("rosbag2_bagfile_information") == std::string::npos
             ? ""
             : advice_on_ros2("the folder of a ROS 2 bag");
}

}  // namespace rumi::camera_driver
