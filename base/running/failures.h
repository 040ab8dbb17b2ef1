// SPDX-License-Identifier: BSD-3-Clause
// Failures that do not end the process are counted, and now and then logged with the last reason.
#pragma once

#include <cstdint>
#include <exception>
#include <string>
#include <utility>

#include "base/running/due.h"

namespace rumi {

// Returns the reason of an exception for a person: file names are kept, and what libraries say about their own code is
// left out.
std::string reason_of(const std::exception& thrown);
// Returns the reason of the exception that is being handled.
std::string what_was_thrown();

// Calls work(). Returns the reason of the exception that it threw, or an empty string.
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
  // `what`: the work that is lost each time, for a person: "a build of the map".
  explicit Failures(std::string what) : what_(std::move(what)) {}

  // Counts `count` failures. Logs the first one, then at most one per minute. Does nothing if `reason` is empty: then
  // nothing failed.
  void note(const std::string& reason, int64_t now_us, int64_t count = 1);
  int64_t count() const { return count_; }
  // Returns "a build of the map broke off (3 so far): why"; empty if nothing has failed.
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
