// SPDX-License-Identifier: BSD-3-Clause
#include "bus/transport/log_bus.h"

#include "bus/transport/handler.h"

namespace rumi {

LogBus::LogBus(std::unique_ptr<LogReader> in, std::unique_ptr<LogWriter> out)
    : in_(std::move(in)), out_(std::move(out)) {}

bool LogBus::publish_raw(const std::string& channel, std::span<const uint8_t> data) {
  if (!out_ || !out_->write(now_us_, channel, data)) return false;
  ++published_;
  return true;
}

void LogBus::subscribe_raw(const std::string& channel, const QueueOptions&, RawHandler handler) {
  Channel& c = channels_[channel];
  c.counts.channel = channel;
  c.handlers.push_back(std::move(handler));
}

int LogBus::dispatch(int) {
  while (in_ && !ended_) {
    const std::optional<LogEvent> event = in_->next();
    ended_ = !event;
    if (ended_) break;
    const auto found = channels_.find(event->channel);
    if (found == channels_.end()) continue;
    now_us_ = event->utime_us;
    Channel& channel = found->second;
    ++channel.counts.received;
    for (const RawHandler& handler : channel.handlers)
      if (!handle_safely(handler, event->channel, event->data, now_us_, &broken_handlers()))
        ++channel.counts.undecodable;
    return 1;
  }
  return 0;
}

std::vector<ChannelCounts> LogBus::counts() const {
  std::vector<ChannelCounts> all;
  for (const auto& [name, channel] : channels_) all.push_back(channel.counts);
  return all;
}

}  // namespace rumi
