// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace rumi {

inline constexpr int64_t kNever_us = INT64_MIN;

// True if the period has passed since `last_us`, if `last_us` is kNever_us, or if the clock was set back since then.
inline bool is_due(int64_t now_us, int64_t last_us, int64_t period_us) {
  return last_us == kNever_us || now_us < last_us || now_us - last_us >= period_us;
}

}  // namespace rumi
