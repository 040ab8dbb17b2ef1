// SPDX-License-Identifier: BSD-3-Clause
// For what threads and other processes take their own time over. How long that was is never asserted: who gives up
// here has met an error, not a busy machine.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace rumi::testing {

inline constexpr std::chrono::minutes kPatience{1};

// Looks every now and then, and does something in between if asked to. False if it never happens.
inline bool happens(
    const std::function<bool()>& condition, const std::function<void()>& meanwhile = [] {}) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    meanwhile();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace rumi::testing
