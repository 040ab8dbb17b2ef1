// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <future>

namespace rumi {

// True if get() does not have to wait for another thread. Also true for a deferred task, which get() runs itself.
template <class T>
bool is_ready(const std::future<T>& result) {
  return result.valid() && result.wait_for(std::chrono::seconds(0)) != std::future_status::timeout;
}

}  // namespace rumi
