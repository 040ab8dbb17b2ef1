// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/recordings/export_log.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "base/exit_codes.h"
#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "camera_driver/open_source.h"
#include "camera_driver/source/image_source.h"

namespace rumi::tool {
namespace {

int fail(const std::string& problem) {
  fmt::print(stderr, "rumi export: {}\n", problem);
  return 1;
}

// Images written, or -1 when the log could not be written.
int64_t write_all(camera_driver::ImageSource& source, const std::string& channel, LogWriter& log) {
  constexpr std::chrono::seconds kProgress{5};
  auto last = std::chrono::steady_clock::now();
  int64_t count = 0;
  while (const std::optional<image_t> image = source.next()) {
    if (!log.write(image->utime, channel, encode_message(*image))) return -1;
    ++count;
    if (const auto now = std::chrono::steady_clock::now(); now - last > kProgress) {
      fmt::print(stderr, "{}{} images\n", count, source.total() < 0 ? "" : fmt::format(" of {}", source.total()));
      last = now;
    }
  }
  return log.close() ? count : -1;
}

}  // namespace

int run_export(const ExportOptions& options) {
  std::error_code code;
  // Also when it is the input itself.
  if (std::filesystem::exists(options.log, code))
    return fail(fmt::format("{}: exists; remove it or give another name", options.log));
  camera_driver::OpenedSource opened = camera_driver::open_recording(options.input, options.camera);
  if (!opened.ok()) return fail(opened.error);

  LogWriter log(options.log);
  if (!log.error().empty()) return fail(log.error());
  const int64_t count = write_all(*opened.source, options.channel, log);
  if (count < 0) {
    const std::string problem = log.error();
    log.close();
    std::filesystem::remove(options.log, code);
    return fail(problem + "; the incomplete log was removed");
  }
  fmt::print("{}: {} images on {}\n", options.log, count, options.channel);
  const std::vector<std::string> complaints = opened.source->skipped().complaints(count);
  for (const std::string& complaint : complaints) fmt::print(stderr, "rumi export: {}\n", complaint);
  return complaints.empty() ? 0 : kNotAll;
}

}  // namespace rumi::tool
