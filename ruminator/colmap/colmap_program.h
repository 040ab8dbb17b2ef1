// SPDX-License-Identifier: BSD-3-Clause
// COLMAP as it is installed here: which options its mapper knows, or why it cannot be used. All windows share one
// object, so that a problem is found once, at the start.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "base/child/run_child.h"
#include "ruminator/colmap/colmap_dialect.h"

namespace rumi::ruminator {

class ColmapProgram {
 public:
  // A program that prints nothing and does nothing for so long waits for somebody to close its window.
  static constexpr double kIdleLimitS = 8;
  explicit ColmapProgram(std::string name, double idle_limit_s = kIdleLimitS)
      : name_(std::move(name)), idle_limit_s_(idle_limit_s) {}
  ~ColmapProgram();  // cancels begin_asking()
  ColmapProgram(const ColmapProgram&) = delete;
  ColmapProgram& operator=(const ColmapProgram&) = delete;

  const std::string& name() const { return name_; }
  // Asks in a thread of its own, so that its problem() is known before the first window.
  void begin_asking();
  // Asks for the help of the mapper, unless it is known, or waits for a question that is running. A program that did
  // not start, or ended with an error, is asked again each time: it costs little, and it may have been installed
  // meanwhile.
  ChildResult ask(int nice, const std::atomic<bool>& cancel);
  // Stops this process from trying it again: it hangs, or needs what the machine does not have.
  void give_up(const std::string& why);
  bool is_given_up() const;

  OptionNames options() const;  // options of `mapper`, without dashes; empty: not known
  std::string version() const;  // "3.8"; empty: not known
  // What is wrong with it and what follows from that, as in the log. Empty while nothing is known to be wrong.
  std::string problem() const;

 private:
  ChildResult question(int nice, const std::atomic<bool>& cancel);
  void tell(const std::string& why);
  void refuse_useless(const std::string& text, ChildResult* help) const;
  void judge(const ChildResult& help, const std::string& text);

  const std::string name_;
  const double idle_limit_s_;
  mutable std::mutex mutex_;  // guards the four members below
  OptionNames options_;
  std::string version_, problem_;
  bool given_up_ = false;
  std::mutex asking_;
  std::atomic<bool> end_ = false;
  std::thread thread_;
};

// Returns the last line of an output that mentions an error, or else its last line; printable.
std::string complaint(std::string_view output);
// True if the output mentions CUDA, or a GPU that is missing.
bool tells_of_gpu(std::string_view output);

}  // namespace rumi::ruminator
