// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <future>

namespace rumi {

// True also for what was put off: it is done when it is asked for.
template <class T>
bool is_ready(const std::future<T>& result) {
  return result.valid() && result.wait_for(std::chrono::seconds(0)) != std::future_status::timeout;
}

}  // namespace rumi
