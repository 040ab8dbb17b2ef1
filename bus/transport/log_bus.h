// SPDX-License-Identifier: BSD-3-Clause
// The bus on lcm log files: dispatches the messages of one file, and publishes into another.
#pragma once

#include <map>
#include <memory>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"

namespace rumi {

class LogBus : public Bus {
 public:
  // Both may be null: without `in` there is nothing to dispatch, without `out` publish_raw() fails.
  LogBus(std::unique_ptr<LogReader> in, std::unique_ptr<LogWriter> out);

  bool publish_raw(const std::string& channel, std::span<const uint8_t> data) override;
  void subscribe_raw(const std::string& channel, const QueueOptions& queue, RawHandler handler) override;
  // Delivers the next event of a subscribed channel. Returns 1, or 0 at the end (see read_error()). Nothing waits and
  // nothing is dropped; timeout_ms is not used.
  int dispatch(int timeout_ms = 0) override;
  // Returns the time of the last event that was delivered, or the one that was set since.
  int64_t now_us() const override { return now_us_; }
  std::vector<ChannelCounts> counts() const override;
  int64_t published() const override { return published_; }

  void set_now_us(int64_t now_us) { now_us_ = now_us; }
  bool ended() const { return ended_; }
  // Says why reading ended before the end of the file; empty if it did not.
  std::string read_error() const { return in_ ? in_->error() : ""; }

 private:
  struct Channel {
    std::vector<RawHandler> handlers;
    ChannelCounts counts;
  };
  std::unique_ptr<LogReader> in_;
  std::unique_ptr<LogWriter> out_;
  std::map<std::string, Channel> channels_;
  int64_t now_us_ = 0;
  int64_t published_ = 0;
  bool ended_ = false;
};

}  // namespace rumi
