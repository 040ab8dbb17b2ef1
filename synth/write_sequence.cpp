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

Result<> write_file(const fs::path& file, const char* data, size_t size) {
  std::ofstream out(file, std::ios::binary);
  out.write(data, static_cast<std::streamsize>(size));
  out.close();
  if (!out) return Error{"cannot be written: " + write_error_text(errno), file.string()};
  return {};
}

Result<> write_file(const fs::path& file, const std::string& text) {
  return write_file(file, text.data(), text.size());
}

std::string pose_line(const std::string& time, const SE3& p) {
  const Eigen::Quaterniond& q = p.rotation;
  return fmt::format("{} {:.6f} {:.6f} {:.6f} {:.9f} {:.9f} {:.9f} {:.9f}\n", time, p.translation.x(),
                     p.translation.y(), p.translation.z(), q.x(), q.y(), q.z(), q.w());
}

Result<> write_frames(const SynthOptions& options, const fs::path& folder, const SynthProgress& progress) {
  SequenceRenderer renderer(options);
  std::string list = "# time file\n",
              truth = "# map_from_cam: t tx ty tz qx qy qz qw; camera axes x right, y down, z forward\n";
  for (int i = 0; i < renderer.frames(); ++i) {
    const std::string time = stamp(renderer.utime_us(i)), name = "rgb/" + time + ".jpg";
    std::vector<uchar> jpeg;
    cv::imencode(".jpg", renderer.render(i), jpeg, {cv::IMWRITE_JPEG_QUALITY, options.jpeg_quality});
    const Result<> written = write_file(folder / name, reinterpret_cast<const char*>(jpeg.data()), jpeg.size());
    if (!written) return written;
    list += time + " " + name + "\n";
    truth += pose_line(time, renderer.map_from_cam(i));
    if (progress && !progress(i + 1, renderer.frames())) return Error{"stopped"};
  }
  Camera camera = renderer.camera();
  if (camera.fps == 0) {
    const double seconds = static_cast<double>(renderer.utime_us(renderer.frames() - 1) - renderer.utime_us(0)) * 1e-6;
    camera.fps = std::round((renderer.frames() - 1) / seconds * 1000) / 1000;
  }
  if (const Result<> written = write_file(folder / "groundtruth.txt", truth); !written) return written;
  if (const Result<> written = write_file(folder / "calibration.yaml", camera_to_yaml(camera)); !written)
    return written;
  return write_file(folder / "rgb.txt", list);  // written last, so a folder that has it is complete
}

}  // namespace

Result<> write_sequence(const SynthOptions& options, const std::string& folder, bool overwrite,
                        const SynthProgress& progress) {
  std::error_code failure;
  if (!overwrite && fs::exists(fs::path(folder) / "rgb.txt", failure))
    return Error{"holds a sequence already (rgb.txt)", folder, "choose another folder or give --overwrite"};
  try {
    fs::create_directories(fs::path(folder) / "rgb");
    fs::remove(fs::path(folder) / "rgb.txt");
    return write_frames(options, folder, progress);
  } catch (const std::exception& e) {
    return Error{reason_of(e)};
  }
}

}  // namespace rumi::synth
