// SPDX-License-Identifier: BSD-3-Clause
// One component's view of a shared bus: it measures the CPU time that the component's handlers take.
#pragma once

#include "base/this_process/cpu_clock.h"
#include "bus/transport/bus.h"
#include "bus/transport/handler.h"

namespace rumi::tool {

// Adds the CPU time of its own lifetime to a sum.
class CpuTimer {
 public:
  explicit CpuTimer(double* sum_s) : sum_s_(sum_s), begin_s_(process_cpu_s()) {}
  ~CpuTimer() { *sum_s_ += process_cpu_s() - begin_s_; }
  CpuTimer(const CpuTimer&) = delete;
  CpuTimer& operator=(const CpuTimer&) = delete;

 private:
  double* sum_s_;
  double begin_s_;
};

class MeteredBus : public Bus {
 public:
  // Adds the CPU seconds of all handlers to *cpu_s. `bus` and `cpu_s` must outlive this object.
  MeteredBus(Bus& bus, double* cpu_s) : bus_(bus), cpu_s_(cpu_s) {}

  bool publish_raw(const std::string& channel, std::span<const uint8_t> data) override {
    return bus_.publish_raw(channel, data);
  }
  void subscribe_raw(const std::string& channel, const QueueOptions& queue, RawHandler handler) override {
    bus_.subscribe_raw(channel, queue, [this, channel, handler = std::move(handler)](std::span<const uint8_t> data) {
      const CpuTimer timer(cpu_s_);
      return handle_safely(handler, channel, data, now_us(), &broken_handlers());
    });
  }
  int dispatch(int timeout_ms) override { return bus_.dispatch(timeout_ms); }
  int64_t now_us() const override { return bus_.now_us(); }
  std::vector<ChannelCounts> counts() const override { return bus_.counts(); }
  int64_t published() const override { return bus_.published(); }

 private:
  Bus& bus_;
  double* cpu_s_;
};

}  // namespace rumi::tool
