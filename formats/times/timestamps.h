// SPDX-License-Identifier: BSD-3-Clause
// Converts times in dataset files to int64 microseconds by integer arithmetic: a double cannot hold nanoseconds since
// 1970.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/text/time_units.h"

namespace rumi {

// The time from image to image if it is not known: 30 Hz.
inline constexpr int64_t kUsualPeriodUs = 33'333;

// Parses a decimal number of `unit`, "1305031102.175304" or "1.305031102175304e+09", rounded to the nearest
// microsecond. Returns nullopt for other texts, negative numbers, and 2^53 us (the year 2255) and above.
std::optional<int64_t> parse_time_us(std::string_view text, TimeUnit unit);
// Writes "1305031102.175304", which parse_time_us() reads back. Precondition: not negative.
std::string format_seconds(int64_t utime_us);

}  // namespace rumi
