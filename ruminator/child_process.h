// SPDX-License-Identifier: BSD-3-Clause
// Runs another program to its end: with a time limit, at low priority, cancellable at any moment.
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace rumi {

struct ChildCommand {
  std::vector<std::string> arguments;  // the program (found in PATH) and its arguments
  std::string log_file;                // stdout and stderr are appended to it
  double time_limit_s = 60;
  int nice = 0;
  int threads = 1;  // OMP_NUM_THREADS and its kin, in the child's environment
};

struct ChildResult {
  enum class Outcome { kExited, kSignalled, kTimedOut, kCancelled, kNotStarted };
  Outcome outcome = Outcome::kNotStarted;
  int exit_code = 0;  // kExited
  int signal = 0;     // kSignalled
  double wall_s = 0, cpu_s = 0;
  bool ok() const { return outcome == Outcome::kExited && exit_code == 0; }
  std::string describe() const;  // "killed by signal 9 (Killed)", "colmap: not found in PATH; install ...", ...
  std::string error;             // kNotStarted: why
};

// Blocks. The child runs in a process group of its own, which is killed as a whole when it has to end, and dies with us
// (PR_SET_PDEATHSIG). Inherits no descriptors but the log.
ChildResult run_child(const ChildCommand& command, const std::atomic<bool>& cancel);

}  // namespace rumi
