// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/recordings/export_log.h"

#include <filesystem>

#include "bus/transport/bus.h"

namespace rumi::tool {

LogSink::LogSink(const std::string& file, std::string channel)
    : file_(file), channel_(std::move(channel)), log_(file) {}

LogSink::~LogSink() {
  if (is_whole_) return;
  log_.close();
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

bool LogSink::write(const image_t& image) { return log_.write(image.utime, channel_, encode_message(image)); }

std::string LogSink::close() {
  is_whole_ = log_.close() && log_.error().empty();
  return log_.error();
}

std::string LogSink::content() const { return "images on " + channel_; }

}  // namespace rumi::tool
