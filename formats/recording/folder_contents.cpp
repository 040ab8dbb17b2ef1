// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/folder_contents.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "base/text/natural_order.h"
#include "bus/transport/log_file.h"
#include "formats/recording/file_kind.h"
#include "formats/recording/list_lines.h"

namespace rumi {

namespace fs = std::filesystem;

bool is_image_name(const fs::path& file) {
  static const std::set<std::string> kExtensions = {".jpg",  ".jpeg", ".png", ".bmp", ".tif",
                                                    ".tiff", ".pgm",  ".ppm", ".webp"};
  return kExtensions.contains(lower_extension(file)) && !file.filename().string().starts_with('.');
}

std::vector<std::string> pictures_not_read(const fs::path& folder) {
  static const std::set<std::string> kExtensions = {".heic", ".heif", ".hif", ".avif", ".jxl", ".jp2", ".j2k", ".gif",
                                                    ".dng",  ".cr2",  ".cr3", ".nef",  ".arw", ".raf", ".orf", ".rw2",
                                                    ".pef",  ".srw",  ".tga", ".exr",  ".hdr", ".psd", ".raw", ".jls"};
  std::vector<std::string> names;
  std::error_code code, ignored;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    const bool is_hidden = it->path().filename().string().starts_with('.');
    if (!is_hidden && kExtensions.contains(lower_extension(it->path())) && it->is_regular_file(ignored))
      names.push_back(it->path().filename().string());
  }
  std::sort(names.begin(), names.end(), natural_less);
  return names;
}

std::string other_files(const fs::path& folder) {
  std::map<std::string, int> count;
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    std::error_code ignored;
    const bool is_hidden = it->path().filename().string().starts_with('.');
    if (!is_hidden && !is_image_name(it->path()) && it->is_regular_file(ignored)) ++count[lower_extension(it->path())];
  }
  constexpr size_t kMostNamed = 6;
  std::vector<std::string> parts;
  for (const auto& [extension, files] : count)
    if (parts.size() < kMostNamed)
      parts.push_back(fmt::format("{} {}", files, extension.empty() ? "without an ending" : printable(extension)));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<fs::path> recording_files(const fs::path& folder) {
  static const std::set<std::string> kExtensions = {".mp4",  ".mov",    ".mkv", ".avi",  ".webm", ".m4v",   ".mpg",
                                                    ".mpeg", ".ts",     ".mts", ".m2ts", ".wmv",  ".flv",   ".3gp",
                                                    ".h264", ".h265",   ".264", ".265",  ".ivf",  ".mjpeg", ".lcm",
                                                    ".log",  ".lcmlog", ".bag", ".db3",  ".mcap"};
  std::vector<fs::path> files;
  std::error_code code, ignored;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    const std::string extension = lower_extension(it->path());
    const bool is_number = extension.size() > 1 && extension.find_first_not_of("0123456789", 1) == std::string::npos;
    if (!kExtensions.contains(extension) && !is_number) continue;
    const bool may_be_other = extension == ".log" || is_number;
    if (it->is_regular_file(ignored) && (!may_be_other || is_lcm_log(it->path().string()))) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end(),
            [](const fs::path& a, const fs::path& b) { return natural_less(a.string(), b.string()); });
  return files;
}

std::string recordings_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::path& file : recording_files(folder)) names.push_back(printable(file.filename().string()));
  constexpr size_t kMostNamed = 4;
  const size_t more = names.size() - std::min(names.size(), kMostNamed);
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace rumi
