// SPDX-License-Identifier: BSD-3-Clause
#include "synth/write_sequence.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "base/running/failures.h"
#include "base/this_process/account_limits.h"
#include "bus/wire/calibration.h"
#include "synth/sequence_renderer.h"

namespace rumi::synth {
namespace {

namespace fs = std::filesystem;

std::string stamp(int64_t utime_us) { return fmt::format("{}.{:06d}", utime_us / 1'000'000, utime_us % 1'000'000); }

std::string write_file(const fs::path& file, const char* data, size_t size) {
  std::ofstream out(file, std::ios::binary);
  out.write(data, static_cast<std::streamsize>(size));
  out.close();
  return out ? std::string() : fmt::format("{}: cannot be written: {}", file.string(), write_error_text(errno));
}

std::string write_file(const fs::path& file, const std::string& text) {
  return write_file(file, text.data(), text.size());
}

std::string pose_line(const std::string& time, const SE3& p) {
  const Eigen::Quaterniond& q = p.rotation;
  return fmt::format("{} {:.6f} {:.6f} {:.6f} {:.9f} {:.9f} {:.9f} {:.9f}\n", time, p.translation.x(),
                     p.translation.y(), p.translation.z(), q.x(), q.y(), q.z(), q.w());
}

std::string write_frames(const SynthOptions& options, const fs::path& folder, const SynthProgress& progress) {
  SequenceRenderer renderer(options);
  std::string list = "# time file\n",
              truth = "# map_from_cam: t tx ty tz qx qy qz qw; camera axes x right, y down, z forward\n";
  for (int i = 0; i < renderer.frames(); ++i) {
    const std::string time = stamp(renderer.utime_us(i)), name = "rgb/" + time + ".jpg";
    std::vector<uchar> jpeg;
    cv::imencode(".jpg", renderer.render(i), jpeg, {cv::IMWRITE_JPEG_QUALITY, options.jpeg_quality});
    const std::string error = write_file(folder / name, reinterpret_cast<const char*>(jpeg.data()), jpeg.size());
    if (!error.empty()) return error;
    list += time + " " + name + "\n";
    truth += pose_line(time, renderer.map_from_cam(i));
    if (progress && !progress(i + 1, renderer.frames())) return "stopped";
  }
  Camera camera = renderer.camera();
  if (camera.fps == 0) {
    const double seconds = static_cast<double>(renderer.utime_us(renderer.frames() - 1) - renderer.utime_us(0)) * 1e-6;
    camera.fps = std::round((renderer.frames() - 1) / seconds * 1000) / 1000;
  }
  if (std::string error = write_file(folder / "groundtruth.txt", truth); !error.empty()) return error;
  if (std::string error = write_file(folder / "calibration.yaml", camera_to_yaml(camera)); !error.empty()) return error;
  return write_file(folder / "rgb.txt", list);  // last: a folder that has it is complete
}

}  // namespace

std::string write_sequence(const SynthOptions& options, const std::string& folder, bool overwrite,
                           const SynthProgress& progress) {
  std::error_code failure;
  if (!overwrite && fs::exists(fs::path(folder) / "rgb.txt", failure))
    return fmt::format("{}: holds a sequence already (rgb.txt); choose another folder or give --overwrite", folder);
  try {
    fs::create_directories(fs::path(folder) / "rgb");
    fs::remove(fs::path(folder) / "rgb.txt");
    return write_frames(options, folder, progress);
  } catch (const std::exception& e) {
    return reason_of(e);
  }
}

}  // namespace rumi::synth
