// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/reserved_space.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "base/files/free_space.h"
#include "base/files/whole_file.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kBytes = 1'000'000;            // for run.json, windows.csv and the picture
constexpr int64_t kBytesPerImage = 400;          // for a line in each of trajectory.txt, submaps/ and frames.csv
constexpr int64_t kMapBytes = 2'000'000;         // for a map with its windows
constexpr int64_t kMapBytesPerImage = 50'000;    // most recordings need 10,000 to 50,000
constexpr int64_t kImagesOfUnknownLength = 100;  // assumed if the number of images is unknown

int64_t bytes_for(int64_t images, int64_t fixed, int64_t per_image) {
  return fixed + per_image * (images < 0 ? kImagesOfUnknownLength : images);
}

double mb(double bytes) { return 1e-6 * bytes; }

}  // namespace

Result<> ReservedSpace::take(const std::string& folder, int64_t images) {
  const int64_t wanted = bytes_for(images, kBytes, kBytesPerImage);
  const auto free = static_cast<double>(free_space(folder).value_or(0));
  const std::string name = temporary_name((fs::path(folder) / "reserved").string());
  file_ = FileDescriptor(open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  unlink(name.c_str());
  const int problem = file_ ? posix_fallocate(file_.get(), 0, wanted) : errno;
  if (problem != ENOSPC && problem != EDQUOT) return {};
  file_.reset();
  return Error{
      fmt::format("its disk has {:.1f} MB free, and the outputs of a run need {:.1f} MB and more: make room, or "
                  "choose another folder",
                  mb(free), mb(static_cast<double>(wanted))),
      folder};
}

std::string doubt_about_space(const std::string& folder, int64_t images) {
  const std::optional<uintmax_t> free = free_space(folder);
  const auto wanted = static_cast<double>(bytes_for(images, kMapBytes, kMapBytesPerImage));
  if (!free || static_cast<double>(*free) >= wanted) return {};
  return fmt::format("{}: its disk has {:.1f} MB free; the map and the windows of such a run may take {:.0f} MB",
                     folder, mb(static_cast<double>(*free)), mb(wanted));
}

}  // namespace rumi::tool
