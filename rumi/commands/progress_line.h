// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

#include "base/running/log.h"

namespace rumi::tool {

// Shows the progress of long work: on a terminal in one line that is printed again and again, otherwise in a line of
// the log now and then.
class ProgressLine {
 public:
  explicit ProgressLine(bool show) : show_(show) {}
  ~ProgressLine() { erase(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // `total` is -1 if unknown. make_text() is called at most twice a second on a terminal; otherwise every ten seconds,
  // and only if at least a twentieth of the work was done since the last time.
  template <class MakeText>
  void update(int64_t done, int64_t total, const MakeText& make_text) {
    if (!show_ || Clock::now() - last_ < (terminal_ ? std::chrono::milliseconds(500) : std::chrono::seconds(10)))
      return;
    if (!terminal_ && 20 * (done - told_) < total) return;
    if (terminal_)
      say(fmt::format("\r{}\x1b[K", make_text()));
    else
      log_info("{}", make_text());
    last_ = Clock::now();
    told_ = done;
    shown_ = terminal_;
  }
  // Erases the line from the terminal.
  void erase() {
    if (shown_) say("\r\x1b[K");
    shown_ = false;
  }
  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  // Unlike fmt::print, fputs does not throw if the terminal was closed.
  static void say(const std::string& text) { std::fputs(text.c_str(), stderr); }
  bool show_, terminal_ = isatty(STDERR_FILENO) != 0, shown_ = false;
  Clock::time_point begin_ = Clock::now(), last_ = begin_;
  int64_t told_ = 0;
};

}  // namespace rumi::tool
