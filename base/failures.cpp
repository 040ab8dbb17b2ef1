// SPDX-License-Identifier: BSD-3-Clause
#include "base/failures.h"

#include <fmt/format.h>

#include <exception>

#include "base/log.h"

namespace rumi {

constexpr int64_t kLogPeriodUs = 60'000'000;

std::string what_was_thrown() {
  try {
    throw;
  } catch (const std::exception& e) {
    const std::string reason = e.what();
    return reason.empty() ? "no reason given" : reason;
  } catch (...) {
    return "what was thrown is no std::exception";
  }
}

void Failures::note(const std::string& reason, int64_t now_us, int64_t count) {
  if (reason.empty()) return;
  count_ += count;
  reason_ = reason;
  news_ = true;
  if (!is_due(now_us, last_log_us_, kLogPeriodUs)) return;
  last_log_us_ = now_us;
  log_error("{}", text());
}

std::string Failures::text() const {
  return count_ == 0 ? "" : fmt::format("{} broke off ({} so far): {}", what_, count_, reason_);
}

}  // namespace rumi
