// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace rumi {

// One line on a terminal, over and over; nothing where it would fill a log.
class ProgressLine {
 public:
  explicit ProgressLine(bool show) : show_(show && isatty(STDERR_FILENO)) {}
  ~ProgressLine() { end(); }

  // make_text() is called twice a second at most.
  template <class MakeText>
  void update(const MakeText& make_text) {
    if (!show_ || Clock::now() - last_ < std::chrono::milliseconds(500)) return;
    fmt::print(stderr, "\r{}\x1b[K", make_text());
    last_ = Clock::now();
    shown_ = true;
  }
  void end() {
    if (shown_) fmt::print(stderr, "\n");
    shown_ = false;
  }
  // Takes the line away.
  void erase() {
    if (shown_) fmt::print(stderr, "\r\x1b[K");
    shown_ = false;
  }
  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  bool show_, shown_ = false;
  Clock::time_point begin_ = Clock::now(), last_ = begin_;
};

}  // namespace rumi
