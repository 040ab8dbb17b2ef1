// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/recordings/export_recording.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "base/this_process/exit_codes.h"
#include "camera_driver/open_source.h"
#include "camera_driver/source/image_source.h"
#include "formats/truth/truth.h"
#include "rumi/recordings/export_bag.h"
#include "rumi/recordings/export_log.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

int fail(const std::string& problem) {
  fmt::print(stderr, "rumi export: {}\n", problem);
  return 1;
}

int64_t write_all(camera_driver::ImageSource& source, ImageSink& sink, const std::atomic<bool>* stop) {
  constexpr std::chrono::seconds kProgress{5};
  auto last = std::chrono::steady_clock::now();
  int64_t count = 0;
  while (const std::optional<image_t> image = stop && *stop ? std::nullopt : source.next()) {
    if (!sink.write(*image)) return count;
    ++count;
    if (const auto now = std::chrono::steady_clock::now(); now - last > kProgress) {
      fmt::print(stderr, "{}{} images\n", count, source.total() < 0 ? "" : fmt::format(" of {}", source.total()));
      last = now;
    }
  }
  return count;
}

// Returns what is wrong with the given names, or an empty string.
std::string check_names(const ExportOptions& options) {
  std::error_code code;
  // This refuses the input itself, too.
  if (fs::exists(options.file, code)) return options.file + ": exists; remove it or give another name";
  const std::string ending = fs::path(options.file).extension().string();
  if (ending == ".db3")
    return options.file + ": bags in SQLite are not written: give NAME.mcap, which ROS 2 reads, too";
  if (!options.poses.empty() && !BagSink::takes(options.file))
    return fmt::format("--poses are written into bags only: give -o NAME.mcap (ROS 2) or NAME.bag (ROS 1), not {}",
                       options.file);
  return {};
}

// Reads the poses of a file or of a run's folder. Returns what is wrong with them, or an empty string.
std::string read_poses(const std::string& given, std::vector<TimedPose>* poses) {
  if (given.empty()) return {};
  std::error_code code;
  const fs::path file = fs::is_directory(given, code) ? fs::path(given) / "trajectory.txt" : fs::path(given);
  if (file != given && !fs::exists(file, code))
    return given + ": has no trajectory.txt: give the output folder of a run";
  TruthFile read = read_groundtruth(file.string());
  for (const std::string& note : read.notes) fmt::print(stderr, "rumi export: {}\n", note);
  if (read.ok() && !read.has_rotations) return file.string() + ": has no rotations, which poses need";
  *poses = std::move(read.poses);
  return read.error;
}

std::unique_ptr<ImageSink> open_sink(const ExportOptions& options, std::vector<TimedPose> poses) {
  const auto channel = [&](const char* usual) { return options.channel.empty() ? usual : options.channel; };
  if (BagSink::takes(options.file))
    return std::make_unique<BagSink>(options.file, channel(kImageTopic), std::move(poses));
  return std::make_unique<LogSink>(options.file, channel(kLcmChannel));
}

}  // namespace

int run_export(const ExportOptions& options) {
  if (const std::string problem = check_names(options); !problem.empty()) return fail(problem);
  std::vector<TimedPose> poses;
  if (const std::string problem = read_poses(options.poses, &poses); !problem.empty()) return fail(problem);
  camera_driver::OpenedSource opened = camera_driver::open_recording(options.input, options.camera);
  if (!opened) return fail(opened.error_text());
  const std::unique_ptr<ImageSink> sink = open_sink(options, std::move(poses));
  const int64_t count = write_all(**opened, *sink, options.stop);
  if (options.stop && *options.stop) return fail(options.file + ": was called off; nothing was written");
  if (const std::string problem = sink->close(); !problem.empty()) return fail(problem + "; nothing was written");
  fmt::print("{}: {} {}\n", options.file, count, sink->content());
  const std::vector<std::string> complaints = (*opened)->skipped().complaints(count);
  for (const std::string& complaint : complaints) fmt::print(stderr, "rumi export: {}\n", complaint);
  return complaints.empty() ? 0 : kNotAll;
}

}  // namespace rumi::tool
