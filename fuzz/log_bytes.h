// SPDX-License-Identifier: BSD-3-Clause
// An lcm log as bytes, and a Mutator that changes its events and writes their headers anew, so that they stay valid.
#pragma once

#include <string>

#include "bus/transport/bus.h"
#include "fuzz/target.h"

namespace rumi::fuzz {

class LogBytes {
 public:
  template <class Message>
  void add(const std::string& channel, const Message& message) {
    add_event(channel, encode_message(message));
  }
  void add_event(const std::string& channel, const Bytes& data);
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
  uint64_t number_ = 0;
};

// A Mutator of inputs that consist of `prefix` bytes, which stay as they are, and a log.
size_t mutate_log_after(size_t prefix, uint8_t* data, size_t size, size_t max_size, unsigned seed);
template <size_t kPrefix>
size_t mutate_log(uint8_t* data, size_t size, size_t max_size, unsigned seed) {
  return mutate_log_after(kPrefix, data, size, max_size, seed);
}

}  // namespace rumi::fuzz
