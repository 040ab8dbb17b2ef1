// SPDX-License-Identifier: BSD-3-Clause
// What all implementations of Bus do with a message.
#pragma once

#include <span>
#include <string>

#include "base/failures.h"
#include "base/log.h"
#include "bus/transport/bus.h"

namespace rumi {

// False if the message was broken or the handler threw, which is logged: a process that holds a map does not end
// because of one message.
inline bool handle_safely(const Bus::RawHandler& handler, const std::string& channel, std::span<const uint8_t> data) {
  bool handled = false;
  const std::string reason = thrown_by([&] { handled = handler(data); });
  if (reason.empty()) return handled;
  log_error("a message on {} could not be handled: {}", channel, reason);
  return false;
}

}  // namespace rumi
