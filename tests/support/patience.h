// SPDX-License-Identifier: BSD-3-Clause
// Waits for threads and other processes, which take their own time. How long they take is never asserted: if a wait
// ends without success, there is an error, and not merely a busy machine.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace rumi::testing {

inline constexpr std::chrono::minutes kPatience{1};

// Waits until the condition is true; calls `meanwhile` in between. Returns false if it never is within kPatience.
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
