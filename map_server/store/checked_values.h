// SPDX-License-Identifier: BSD-3-Clause
// Values of map.db's columns, checked. SQLite has checked the pages; a wrong number in them would crash whoever uses
// it. All readers of tables throw std::runtime_error for such a number; MapStore::load() makes an Error of it.
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

// A number of an enumeration that counts up.
template <class Enum>
Enum checked_enum(const char* what, int64_t value, Enum first, Enum last) {
  if (value < static_cast<int64_t>(first) || value > static_cast<int64_t>(last))
    throw std::runtime_error(fmt::format("{} {} is none", what, value));
  return static_cast<Enum>(value);
}

}  // namespace rumi::map_server
