// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/library_messages.h"

#include <array>
#include <iostream>
#include <opencv2/core/utils/logger.hpp>
#include <string>

#include "base/log.h"

extern "C" {
#include <libavutil/log.h>
}

namespace rumi::camera_driver {
namespace {

void log_without_end_of_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  if (!text.empty()) log_debug("{}", text);
}

void log_of_ffmpeg(void* context, int level, const char* format, va_list arguments) {
  if (level > AV_LOG_WARNING || !is_logged(LogLevel::kDebug)) return;
  std::array<char, 500> line{};
  int prefix = 1;
  av_log_format_line(context, level, format, arguments, line.data(), static_cast<int>(line.size()), &prefix);
  log_without_end_of_line(line.data());
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
  stderr = nowhere();  // glibc's is a variable; the log keeps the one of its start
}

DecoderMessages::~DecoderMessages() {
  stderr = stderr_;
  std::cerr.rdbuf(cerr_);
  log_without_end_of_line(text_.str());
}

}  // namespace rumi::camera_driver
