// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bus/transport/log_file.h"
#include "rumi/recordings/image_sink.h"

namespace rumi::tool {

// Writes an lcm log, in which the time of an event is that of its image. The file has a temporary name until it is
// complete.
class LogSink : public ImageSink {
 public:
  LogSink(const std::string& file, std::string channel);
  ~LogSink() override;
  bool write(const image_t& image) override;
  std::string close() override;
  std::string content() const override;

 private:
  std::string file_, temporary_, channel_;
  LogWriter log_;
  bool is_whole_ = false;
};

}  // namespace rumi::tool
