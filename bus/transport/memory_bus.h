// SPDX-License-Identifier: BSD-3-Clause
// The bus of replay and of the tests: everything happens in one process and on one thread, in order. Its clock is set
// by whoever drives it.
#pragma once

#include <deque>
#include <map>

#include "bus/transport/bus.h"

namespace rumi {

class MemoryBus : public Bus {
 public:
  bool publish_raw(const std::string& channel, std::span<const uint8_t> data) override;
  void subscribe_raw(const std::string& channel, const QueueOptions& queue, RawHandler handler) override;
  // Runs handlers until no message waits, not even one that a handler published; timeout_ms is not used. Queues are
  // unbounded here: nothing is ever dropped, so that a replay sees every message.
  int dispatch(int timeout_ms = 0) override;
  int64_t now_us() const override { return now_us_; }
  std::vector<ChannelCounts> counts() const override;
  int64_t published() const override { return published_; }

  void set_now_us(int64_t now_us) { now_us_ = now_us; }
  // The tap sees every message when it is published (to record a log, to count, to disturb in tests); it returns false
  // to lose the message.
  void set_tap(std::function<bool(const std::string& channel, std::span<const uint8_t>)> tap) { tap_ = std::move(tap); }

 private:
  struct Channel {
    std::vector<RawHandler> handlers;
    ChannelCounts counts;
  };
  std::map<std::string, Channel> channels_;
  std::deque<std::pair<std::string, std::vector<uint8_t>>> queue_;
  std::function<bool(const std::string&, std::span<const uint8_t>)> tap_;
  int64_t now_us_ = 0;
  int64_t published_ = 0;
};

}  // namespace rumi
