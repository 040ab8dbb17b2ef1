// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/recordings/export_log.h"

#include <filesystem>

#include "base/files/whole_file.h"
#include "bus/transport/bus.h"

namespace rumi::tool {

LogSink::LogSink(const std::string& file, std::string channel)
    : file_(file), temporary_(temporary_name(file)), channel_(std::move(channel)), log_(temporary_) {}

LogSink::~LogSink() {
  if (is_whole_) return;
  log_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

bool LogSink::write(const image_t& image) { return log_.write(image.utime, channel_, encode_message(image)); }

std::string LogSink::close() {
  is_whole_ = log_.close() && log_.error().empty();
  if (is_whole_) return commit_file(temporary_, file_).error_text();
  std::string problem = log_.error();
  if (const size_t at = problem.find(temporary_); at != std::string::npos)
    problem.replace(at, temporary_.size(), file_);
  return problem;
}

std::string LogSink::content() const { return "images on " + channel_; }

}  // namespace rumi::tool
