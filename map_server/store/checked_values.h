// SPDX-License-Identifier: BSD-3-Clause
// Checks values from map.db. SQLite checks the file's pages only; an invalid number in them would crash the code that
// uses it. All readers of tables throw std::runtime_error for an invalid value, and MapStore::load() turns that into an
// Error.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <stdexcept>

#include "bus/transport/bus.h"

namespace rumi::map_server {

inline int64_t checked_utime(int64_t utime_us) {
  if (!plausible_utime(utime_us)) throw std::runtime_error(fmt::format("{} is no time", utime_us));
  return utime_us;
}

// Returns the enumeration's value of this number. Throws if it is not between `first` and `last`. `what`: for the
// error.
template <class Enum>
Enum checked_enum(const char* what, int64_t value, Enum first, Enum last) {
  if (value < static_cast<int64_t>(first) || value > static_cast<int64_t>(last))
    throw std::runtime_error(fmt::format("{} {} is none", what, value));
  return static_cast<Enum>(value);
}

}  // namespace rumi::map_server
