// SPDX-License-Identifier: BSD-3-Clause
// Failures of a process that goes on: they are counted, and logged now and then with the last reason.
#pragma once

#include <cstdint>
#include <exception>
#include <string>
#include <utility>

#include "base/running/due.h"

namespace rumi {

// The reason of an exception, for a person: texts of libraries about their own code are left out, and files are named.
std::string reason_of(const std::exception& thrown);
// The reason of the exception that is being handled.
std::string what_was_thrown();

// Why it broke off; empty if it did not.
template <class Work>
std::string thrown_by(const Work& work) {
  try {
    work();
    return {};
  } catch (...) {
    return what_was_thrown();
  }
}

class Failures {
 public:
  // `what`: what is lost each time, for a person: "a build of the map".
  explicit Failures(std::string what) : what_(std::move(what)) {}

  // The first one is logged, then one a minute at most. An empty reason: nothing broke off.
  void note(const std::string& reason, int64_t now_us, int64_t count = 1);
  int64_t count() const { return count_; }
  // "a build of the map broke off (3 so far): why"; empty if none did.
  std::string text() const;
  // True if failures were noted since the last call.
  bool take_news() { return std::exchange(news_, false); }

 private:
  std::string what_, reason_;
  int64_t count_ = 0;
  int64_t last_log_us_ = kNever_us;
  bool news_ = false;
};

}  // namespace rumi
