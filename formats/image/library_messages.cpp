// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/library_messages.h"

#include <array>
#include <atomic>
#include <iostream>
#include <opencv2/core/utils/logger.hpp>
#include <string>

#include "base/running/log.h"

extern "C" {
#include <libavutil/log.h>
}

namespace rumi {
namespace {

std::string without_end_of_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text;
}

std::atomic<bool> g_complained = false;

// Logs the first error as a warning for the user: after an error the decoder goes on, but its images may be damaged.
void log_of_ffmpeg(void* context, int level, const char* format, va_list arguments) {
  if (level > AV_LOG_WARNING) return;
  const bool is_first = level <= AV_LOG_ERROR && !g_complained.exchange(true);
  if (!is_first && !is_logged(LogLevel::kDebug)) return;
  std::array<char, 500> line{};
  int prefix = is_first ? 0 : 1;
  av_log_format_line(context, level, format, arguments, line.data(), static_cast<int>(line.size()), &prefix);
  const std::string text = without_end_of_line(line.data());
  if (is_first)
    log_warning("FFmpeg says of the recording: '{}'; images near that place may be damaged; more like it is not shown",
                text);
  else
    log_debug("FFmpeg: {}", text);
}

// Never closed: another thread may be about to write to it.
std::FILE* nowhere() {
  static std::FILE* const kNowhere = std::fopen("/dev/null", "w");
  return kNowhere ? kNowhere : stderr;
}

}  // namespace

void log_what_ffmpeg_says() { av_log_set_callback(log_of_ffmpeg); }

DecoderMessages::DecoderMessages() : stderr_(stderr), cerr_(std::cerr.rdbuf(text_.rdbuf())) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  stderr = nowhere();  // a variable in glibc; our log keeps the stream that it began with
}

DecoderMessages::~DecoderMessages() {
  stderr = stderr_;
  std::cerr.rdbuf(cerr_);
  if (const std::string text = without_end_of_line(text_.str()); !text.empty()) log_debug("OpenCV: {}", text);
}

}  // namespace rumi
