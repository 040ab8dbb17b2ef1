// SPDX-License-Identifier: BSD-3-Clause
// The units in which files have times.
#pragma once

#include <array>
#include <cstddef>

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

}  // namespace rumi
