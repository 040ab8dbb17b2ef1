// SPDX-License-Identifier: BSD-3-Clause
#include "bus/transport/memory_bus.h"

#include "bus/transport/handler.h"

namespace rumi {

bool MemoryBus::publish_raw(const std::string& channel, std::span<const uint8_t> data) {
  ++published_;
  if (tap_ && !tap_(channel, data)) return true;
  if (channels_.contains(channel)) queue_.emplace_back(channel, std::vector<uint8_t>(data.begin(), data.end()));
  return true;
}

void MemoryBus::subscribe_raw(const std::string& channel, const QueueOptions&, RawHandler handler) {
  Channel& c = channels_[channel];
  c.counts.channel = channel;
  c.handlers.push_back(std::move(handler));
}

int MemoryBus::dispatch(int) {
  int handled = 0;
  while (!queue_.empty()) {
    const auto [name, data] = std::move(queue_.front());
    queue_.pop_front();
    ++handled;
    Channel& channel = channels_[name];
    ++channel.counts.received;
    for (const RawHandler& handler : channel.handlers)
      if (!handle_safely(handler, name, data, now_us_, &broken_handlers())) ++channel.counts.undecodable;
  }
  return handled;
}

std::vector<ChannelCounts> MemoryBus::counts() const {
  std::vector<ChannelCounts> all;
  for (const auto& [name, channel] : channels_) all.push_back(channel.counts);
  return all;
}

}  // namespace rumi
