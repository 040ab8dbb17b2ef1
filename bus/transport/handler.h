// SPDX-License-Identifier: BSD-3-Clause
// All implementations of Bus handle a message in the same way.
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>

#include "base/running/failures.h"
#include "bus/transport/bus.h"

namespace rumi {

// Returns false if the message was broken. A handler that throws is no fault of the message: it is noted in `broken`,
// and the process goes on.
inline bool handle_safely(const Bus::RawHandler& handler, const std::string& channel, std::span<const uint8_t> data,
                          int64_t now_us, Failures* broken) {
  bool decoded = true;
  const std::string reason = thrown_by([&] { decoded = handler(data); });
  if (!reason.empty()) broken->note(fmt::format("{}: {}", channel, reason), now_us);
  return decoded;
}

}  // namespace rumi
