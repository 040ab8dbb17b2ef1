// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/reserved_space.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "base/whole_file.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kBytes = 1'000'000;            // run.json, windows.csv, the picture
constexpr int64_t kBytesPerImage = 400;          // a line each in trajectory.txt, submaps/ and frames.csv
constexpr int64_t kMapBytes = 2'000'000;         // of a map with its windows
constexpr int64_t kMapBytesPerImage = 50'000;    // 10,000 to 50,000 in most recordings
constexpr int64_t kImagesOfUnknownLength = 100;  // at least

int64_t bytes_for(int64_t images, int64_t fixed, int64_t per_image) {
  return fixed + per_image * (images < 0 ? kImagesOfUnknownLength : images);
}

double mb(int64_t bytes) { return 1e-6 * static_cast<double>(bytes); }

// -1 where nobody knows.
int64_t free_bytes(const std::string& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return error ? -1 : static_cast<int64_t>(std::min<uintmax_t>(space.available, INT64_MAX));
}

}  // namespace

std::string ReservedSpace::take(const std::string& folder, int64_t images) {
  const int64_t wanted = bytes_for(images, kBytes, kBytesPerImage);
  const int64_t free = free_bytes(folder);
  const std::string name = temporary_name((fs::path(folder) / "reserved").string());
  file_ = FileDescriptor(open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  unlink(name.c_str());
  const int problem = file_ ? posix_fallocate(file_.get(), 0, wanted) : errno;
  if (problem != ENOSPC && problem != EDQUOT) return {};
  file_.reset();
  return fmt::format(
      "{}: its disk has {:.1f} MB free, and the outputs of a run need {:.1f} MB and more: make room, or choose another "
      "folder",
      folder, mb(std::max<int64_t>(0, free)), mb(wanted));
}

std::string doubt_about_space(const std::string& folder, int64_t images) {
  const int64_t free = free_bytes(folder), wanted = bytes_for(images, kMapBytes, kMapBytesPerImage);
  if (free < 0 || free >= wanted) return {};
  return fmt::format("{}: its disk has {:.1f} MB free; the map and the windows of such a run may take {:.0f} MB",
                     folder, mb(free), mb(wanted));
}

}  // namespace rumi::tool
