// SPDX-License-Identifier: BSD-3-Clause
// The bus on LCM. A thread of its own receives into bounded queues (LCM's own would drop the newest message and count
// nothing); handlers run in dispatch(), on the caller's thread, in the order in which the messages arrived.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <mutex>
#include <optional>

#include "base/result.h"
#include "base/running/worker.h"
#include "bus/transport/bus.h"

namespace rumi {

// Nodes use the names of bus.h; these are the names on the wire.
struct ChannelNames {
  std::string prefix;                      // put before every name, so that several robots can share one bus
  std::string camera = channels::kCamera;  // the name on the wire of channels::kCamera
  std::string on_wire(const std::string& channel) const;
};

class LcmBus : public Bus {
 public:
  // An Error says why the URL or the names cannot be used, and what to do.
  static Result<std::unique_ptr<LcmBus>> open(const std::string& url, const ChannelNames& names);
  ~LcmBus() override;

  // May be called from any thread.
  bool publish_raw(const std::string& channel, std::span<const uint8_t> data) override;
  // Throws std::runtime_error if LCM refuses (its multicast self test failed). To be called on the dispatching thread.
  void subscribe_raw(const std::string& channel, const QueueOptions& queue, RawHandler handler) override;
  // Handles only the messages that had arrived when it stopped waiting, so that a flood cannot keep it from returning.
  int dispatch(int timeout_ms) override;
  int64_t now_us() const override;
  std::vector<ChannelCounts> counts() const override;  // one per subscription, with the names of bus.h
  int64_t published() const override { return published_; }

 private:
  struct Message {
    int64_t sequence = 0;  // order of arrival, over all subscriptions
    std::vector<uint8_t> data;
  };
  struct Subscription {
    LcmBus* bus = nullptr;
    QueueOptions queue;
    RawHandler handler;
    ChannelCounts counts;
    std::deque<Message> waiting;
  };
  LcmBus(std::string url, std::unique_ptr<lcm::LCM> lcm, ChannelNames names);
  void receive();
  void enqueue(Subscription& subscription, std::span<const uint8_t> data);
  void note_dropped(Subscription& subscription);
  Subscription* next_before(int64_t sequence);

  const std::string url_;
  const ChannelNames names_;
  std::unique_ptr<lcm::LCM> lcm_;
  std::atomic<int64_t> published_ = 0;

  mutable std::mutex mutex_;  // guards the members below it
  std::condition_variable arrived_;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  int64_t next_sequence_ = 0;
  int waiting_ = 0;  // messages in all queues

  std::atomic<bool> stop_ = false;
  std::optional<Worker> receiver_;  // the last member, so that its thread ends before the others are destroyed
};

// Returns advice with the two commands that let multicast of this udpm:// URL work on one machine.
std::string multicast_advice(const std::string& url);
// Returns advice if the URL does not ask for a receive buffer, so that raw images may be lost, or asks for a larger one
// than the kernel allows (net.core.rmem_max); otherwise an empty string.
std::string receive_buffer_advice(const std::string& url, int64_t rmem_max);

}  // namespace rumi
