// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "base/log.h"
#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "camera_driver/recording/frame_reader.h"

namespace rumi::camera_driver {
namespace {

class LogFrameReader : public FrameReader {
 public:
  LogFrameReader(std::string file, std::string channel) : file_(std::move(file)), channel_(std::move(channel)) {
    rewind();
  }

  std::optional<FrameStamp> advance() override {
    while (const std::optional<LogEvent> event = log_->next_on(channel_)) {
      const std::string where = fmt::format("{}: image {}", file_, number_++);
      if (Bus::decode(event->data, &image_) && plausible_utime(image_.utime)) return FrameStamp{image_.utime, where};
      if (malformed_.count++ == 0) malformed_.first = where + ": is no image_t message, broken, or of no time";
    }
    if (!log_->error().empty()) log_warning("{}", log_->error());
    return std::nullopt;
  }
  std::optional<image_t> load(bool, std::string* error) override {
    const std::string problem = check_image(image_);
    if (problem.empty()) return image_;
    *error = fmt::format("{}: image {}: {}", file_, number_ - 1, problem);
    return std::nullopt;
  }
  void rewind() override {
    log_.emplace(file_);
    number_ = 0;
    malformed_ = {};
  }
  Malformed malformed() const override { return malformed_; }
  const std::string& error() const { return log_->error(); }

 private:
  std::string file_, channel_;
  std::optional<LogReader> log_;
  image_t image_;
  int64_t number_ = 0;
  Malformed malformed_;
};

}  // namespace

OpenedReader open_log(const std::filesystem::path& file, const std::string& channel) {
  auto reader = std::make_unique<LogFrameReader>(file.string(), channel);
  if (!reader->error().empty()) return {nullptr, reader->error()};
  if (!reader->advance())
    return {nullptr, reader->malformed().count > 0
                         ? reader->malformed().first
                         : fmt::format("{}: no message on channel '{}'; name the images' channel with "
                                       "--set camera_driver.log_channel=NAME",
                                       file.string(), channel)};
  reader->rewind();
  return {std::move(reader), ""};
}

}  // namespace rumi::camera_driver
