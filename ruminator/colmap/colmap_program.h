// SPDX-License-Identifier: BSD-3-Clause
// The installed COLMAP: which options its mapper knows, or why it cannot be used. All windows share one object, so that
// a problem is found only once, at the start.
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
  // A program that prints nothing and uses no CPU for this long probably waits for a user to close its window.
  static constexpr double kIdleLimitS = 8;
  explicit ColmapProgram(std::string name, double idle_limit_s = kIdleLimitS)
      : name_(std::move(name)), idle_limit_s_(idle_limit_s) {}
  ~ColmapProgram();  // cancels the question of begin_asking()
  ColmapProgram(const ColmapProgram&) = delete;
  ColmapProgram& operator=(const ColmapProgram&) = delete;

  const std::string& name() const { return name_; }
  // Asks in a thread of its own, so that problem() is known before the first window.
  void begin_asking();
  // Asks the mapper for its help, unless the options are known. If a question is running, waits for it. If the program
  // did not start or ended with an error, it is asked again each time: that costs little, and COLMAP may have been
  // installed meanwhile. Returns the result of the question; a success if the options were known; a failure after
  // give_up().
  ChildResult ask(int nice, const std::atomic<bool>& cancel);
  // Makes this process stop using COLMAP, because it hangs or needs hardware that the machine does not have.
  void give_up(const std::string& why);
  bool is_given_up() const;

  OptionNames options() const;  // options of `mapper`, without the leading dashes; empty: unknown
  std::string version() const;  // such as "3.8"; empty: unknown
  // Returns the fault of the program and its consequence, as logged; empty if no fault is known.
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

// Returns the last line of the output that mentions an error, or else its last line, without control characters.
std::string complaint(std::string_view output);
// True if the line that complaint() returns mentions CUDA, OpenGL or a missing GPU.
bool tells_of_gpu(std::string_view output);

}  // namespace rumi::ruminator
