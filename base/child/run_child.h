// SPDX-License-Identifier: BSD-3-Clause
// Runs another program to its end: with a time limit, at low priority, cancellable at any moment.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace rumi {

struct ChildCommand {
  std::vector<std::string> arguments;               // the program (found in PATH, or a path) and its arguments
  std::vector<std::string> environment;             // NAME=value, besides ours
  std::string log_file;                             // stdout and stderr are appended to it; empty: no log
  size_t log_limit_bytes = 1 << 20;                 // output beyond it is left out of the log, but not of last_output
  std::function<void(std::string_view)> on_output;  // called in this thread with the output as it comes; may be empty
  double time_limit_s = 60;                         // wall clock; ends a child that hangs
  // How long its first process may use hardly any CPU time and print nothing.
  double idle_limit_s = std::numeric_limits<double>::infinity();
  double cpu_limit_s = std::numeric_limits<double>::infinity();  // CPU time of its first process, all threads
  int nice = 0;                                                  // our niceness, if that is higher
  int threads = 1;  // OMP_NUM_THREADS and its kin, in the child's environment
};

struct ChildResult {
  enum class Outcome { kExited, kSignalled, kTimedOut, kCancelled, kNotStarted };
  Outcome outcome = Outcome::kNotStarted;
  int exit_code = 0;             // kExited
  int signal = 0;                // kSignalled
  bool was_idle = false;         // kTimedOut, by idle_limit_s
  double wall_s = 0, cpu_s = 0;  // CPU: its own and that of the children it waited for
  std::string last_output;       // the end of its output, at most 16 KiB
  bool ok() const { return outcome == Outcome::kExited && exit_code == 0; }
  std::string describe() const;  // "killed by signal 9 (Killed)", "colmap: not found in PATH; install ...", ...
  std::string error;             // kNotStarted: why
};

// Runs the command and blocks until it has ended. The child has a process group of its own. The whole group is killed
// when a limit is met or `cancel` becomes true (SIGTERM, and SIGKILL a second later), and when its first process has
// ended. The first process dies with the calling thread (PR_SET_PDEATHSIG).
ChildResult run_child(const ChildCommand& command, const std::atomic<bool>& cancel);

}  // namespace rumi
