// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/log_bytes.h"

#include <algorithm>

#include "fuzz/mutation.h"

namespace rumi::fuzz {
namespace {

constexpr size_t kHeaderBytes = 28;
constexpr size_t kChannelLengthAt = 20, kDataLengthAt = 24;

struct LoggedEvent {
  std::string channel;
  Bytes data;
};

uint32_t number_at(View bytes) { return uint32_t{bytes[0]} << 24 | bytes[1] << 16 | bytes[2] << 8 | bytes[3]; }

std::vector<LoggedEvent> parse(View log) {
  std::vector<LoggedEvent> events;
  while (log.size() >= kHeaderBytes) {
    const size_t channel = number_at(log.subspan(kChannelLengthAt)), data = number_at(log.subspan(kDataLengthAt));
    log = log.subspan(kHeaderBytes);
    if (channel > log.size() || data > log.size() - channel) break;
    const View bytes = log.subspan(channel, data);
    events.push_back({to_text(log.first(channel)), {bytes.begin(), bytes.end()}});
    log = log.subspan(channel + data);
  }
  return events;
}

}  // namespace

void LogBytes::add_event(const std::string& channel, const Bytes& data) {
  const auto put = [this](uint64_t value, int count) {
    for (int i = count - 1; i >= 0; --i) bytes_.push_back(static_cast<uint8_t>(value >> 8 * i));
  };
  put(0xEDA1DA01, 4);
  put(number_, 8);
  put(++number_ * 1000, 8);
  put(channel.size(), 4);
  put(data.size(), 4);
  bytes_.insert(bytes_.end(), channel.begin(), channel.end());
  bytes_.insert(bytes_.end(), data.begin(), data.end());
}

size_t mutate_log_after(size_t prefix, uint8_t* data, size_t size, size_t max_size, unsigned seed) {
  Random random(seed);
  if (size < prefix || below(random, 8) == 0) return 0;
  std::vector<LoggedEvent> events = parse({data + prefix, size - prefix});
  if (events.empty()) return 0;
  const size_t at = below(random, events.size());
  const auto place = events.begin() + static_cast<ptrdiff_t>(at);
  switch (below(random, 12)) {
    case 0:
      events.erase(place);
      break;
    case 1: {
      const LoggedEvent copy = *place;
      events.insert(place, copy);
      break;
    }
    case 2:
      std::swap(*place, events[below(random, events.size())]);
      break;
    default:
      mutate_after(random, kFingerprintBytes, &place->data);
  }
  LogBytes log;
  for (const LoggedEvent& event : events) log.add_event(event.channel, event.data);
  if (log.bytes().size() + prefix > max_size) return 0;
  std::copy(log.bytes().begin(), log.bytes().end(), data + prefix);
  return log.bytes().size() + prefix;
}

}  // namespace rumi::fuzz
