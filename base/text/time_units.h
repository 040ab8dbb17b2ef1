// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace rumi {

enum class TimeUnit { kSeconds, kMilliseconds, kMicroseconds, kNanoseconds };

inline constexpr std::array kTimeUnits = {TimeUnit::kSeconds, TimeUnit::kMilliseconds, TimeUnit::kMicroseconds,
                                          TimeUnit::kNanoseconds};

inline const char* name_of(TimeUnit unit) {
  constexpr std::array kNames = {"seconds", "milliseconds", "microseconds", "nanoseconds"};
  return kNames.at(static_cast<std::size_t>(unit));
}

constexpr double per_second(TimeUnit unit) {
  constexpr std::array kPerSecond = {1.0, 1e3, 1e6, 1e9};
  return kPerSecond.at(static_cast<std::size_t>(unit));
}

// Rounds to whole microseconds. A double holds six decimals of a second until the year 2255, so this recovers exactly
// the microseconds that were written.
inline int64_t to_us(double seconds) { return std::llround(1e6 * seconds); }

}  // namespace rumi
