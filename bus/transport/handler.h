// SPDX-License-Identifier: BSD-3-Clause
// Lets all implementations of Bus handle a message in the same way.
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>

#include "base/running/failures.h"
#include "bus/transport/bus.h"

namespace rumi {

// Returns false if the message could not be decoded. If the handler throws, that is no fault of the message: the
// exception is noted in `broken`, the process goes on, and the result is true.
inline bool handle_safely(const Bus::RawHandler& handler, const std::string& channel, std::span<const uint8_t> data,
                          int64_t now_us, Failures* broken) {
  bool decoded = true;
  const std::string reason = thrown_by([&] { decoded = handler(data); });
  if (!reason.empty()) broken->note(fmt::format("{}: {}", channel, reason), now_us);
  return decoded;
}

}  // namespace rumi
