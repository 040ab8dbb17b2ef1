// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/recordings/import_log.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <span>

#include "base/this_process/account_limits.h"
#include "base/this_process/exit_codes.h"
#include "bus/transport/log_file.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "camera_driver/open_source.h"
#include "camera_driver/source/image_source.h"
#include "formats/bag/bag_file.h"
#include "formats/bag/bag_poses.h"
#include "formats/recording/foreign_recording.h"
#include "formats/times/timestamps.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

int fail(const std::string& problem) {
  fmt::print(stderr, "rumi import: {}\n", problem);
  return 1;
}

// Returns why the file could not be written, or an empty string.
std::string write_file(const fs::path& file, std::span<const uint8_t> bytes) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (stream) return {};
  return fmt::format("{}: cannot be written: {}", file.string(),
                     errno != 0 ? write_error_text(errno) : "unknown reason");
}

std::string write_text(const fs::path& file, const std::string& text) {
  return write_file(file, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

// Sets *bytes to the content of a file for the image, and returns its extension. If the pixels cannot be read, returns
// an empty extension and says why in *error.
std::string to_file(const image_t& image, std::vector<uint8_t>* bytes, std::string* error) {
  if (image.pixelformat == image_t::PIXEL_FORMAT_MJPEG) {
    *bytes = image.data;
    return ".jpg";
  }
  const bool grey = image.pixelformat == image_t::PIXEL_FORMAT_GRAY;
  const Result<cv::Mat> pixels = grey ? decode_grey(image) : decode_bgr(image);
  *error = pixels.error_text();
  if (!pixels || !cv::imencode(".png", *pixels, *bytes)) return {};
  return ".png";
}

// Writes the camera's path as groundtruth.txt, if the recording is a bag with transforms. Prints why if they do not
// give the path. Returns an error of writing, or an empty string.
std::string write_truth(const ImportOptions& options) {
  if (kind_of_bag(options.log) == BagKind::kNone) return {};
  const BagPoses bag = poses_in_bag(options.log, options.camera.log_channel);
  if (!bag.has_transforms) return {};
  if (!bag.error.empty()) {
    fmt::print(stderr, "rumi import: there is no groundtruth.txt: {}\n", bag.error);
    return {};
  }
  std::string lines = "# " + bag.note + "\n# seconds tx ty tz qx qy qz qw\n";
  for (const auto& [utime_us, pose] : bag.poses) {
    const Eigen::Vector3d& t = pose.translation;
    const Eigen::Quaterniond& q = pose.rotation;
    lines += fmt::format("{} {} {} {} {} {} {} {}\n", format_seconds(utime_us), t.x(), t.y(), t.z(), q.x(), q.y(),
                         q.z(), q.w());
  }
  return write_text(fs::path(options.folder) / "groundtruth.txt", lines);
}

// Writes the image's mask, if it has one, to masks/NAME.png, where camera_driver looks for it. Returns the error, or an
// empty string.
std::string write_mask(const image_t& image, const fs::path& folder, const std::string& name) {
  const std::string mask(metadata(image, kMaskKey));
  if (mask.empty()) return {};
  const fs::path file = folder / "masks" / (name + ".png");
  std::error_code code;
  fs::create_directories(file.parent_path(), code);
  return write_text(file, mask);
}

// Writes the images, their list and the calibration. Returns the error, or an empty string.
std::string write_folder(camera_driver::ImageSource& source, const fs::path& folder, int64_t* count) {
  std::error_code code;
  fs::create_directories(folder / "rgb", code);
  if (code) return fmt::format("{}: cannot be created: {}", (folder / "rgb").string(), code.message());
  std::string list = "# seconds file\n", problem;
  std::vector<uint8_t> bytes;
  std::set<std::string> names;
  while (const std::optional<image_t> image = source.next()) {
    const std::string extension = to_file(*image, &bytes, &problem);
    if (extension.empty()) return fmt::format("the image at {} s: {}", format_seconds(image->utime), problem);
    const std::string time = format_seconds(image->utime);
    // Two images may have the same time if the clock was set back.
    const std::string more = names.insert(time).second ? "" : fmt::format("_{}", *count);
    const std::string name = "rgb/" + time + more + extension;
    if (problem = write_file(folder / name, bytes); !problem.empty()) return problem;
    if (problem = write_mask(*image, folder, name); !problem.empty()) return problem;
    list += time + " " + name + "\n";
    ++*count;
  }
  if (problem = write_text(folder / "rgb.txt", list); !problem.empty()) return problem;
  return write_text(folder / "calibration.yaml", camera_to_yaml(source.camera()));
}

}  // namespace

int run_import(const ImportOptions& options) {
  std::error_code code;
  if (fs::exists(options.folder, code) && !fs::is_empty(options.folder, code))
    return fail(fmt::format("{}: exists and is not empty; give another folder", options.folder));
  if (fs::is_regular_file(options.log, code) && !is_lcm_log(options.log) &&
      kind_of_bag(options.log) == BagKind::kNone) {
    const std::string advice = advice_on_foreign_recording(options.log);
    const char* usual = "is no lcm log and no ROS bag; give one, as lcm-logger, `rumi export` or ROS writes it";
    return fail(fmt::format("{}: {}", options.log, advice.empty() ? usual : advice));
  }
  camera_driver::OpenedSource opened = camera_driver::open_recording(options.log, options.camera);
  if (!opened) return fail(opened.error_text());

  int64_t count = 0;
  std::string problem = write_folder(**opened, options.folder, &count);
  if (problem.empty()) problem = write_truth(options);
  if (!problem.empty()) return fail(fmt::format("{}; {} is incomplete ({} images)", problem, options.folder, count));
  fmt::print("{}: {} images\n", options.folder, count);
  const std::vector<std::string> complaints = (*opened)->skipped().complaints(count);
  for (const std::string& complaint : complaints) fmt::print(stderr, "rumi import: {}\n", complaint);
  return complaints.empty() ? 0 : kNotAll;
}

}  // namespace rumi::tool
