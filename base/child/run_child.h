// SPDX-License-Identifier: BSD-3-Clause
// Runs another program to its end, with a time limit and at low priority. It can be cancelled at any moment.
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
  std::vector<std::string> environment;             // NAME=value; replaces or adds to the variables of this process
  std::string log_file;                             // file that stdout and stderr are appended to; empty: no log
  size_t log_limit_bytes = 1 << 20;                 // bytes that one run may add to the log; last_output is not
                                                    // limited by it
  std::function<void(std::string_view)> on_output;  // called in the calling thread as output comes; may be empty
  double time_limit_s = 60;                         // wall clock; longer runs are ended
  // time after which the program is ended if nothing was printed in it and its first process used hardly any CPU time
  double idle_limit_s = std::numeric_limits<double>::infinity();
  double cpu_limit_s = std::numeric_limits<double>::infinity();  // CPU time of its first process, all threads
  int nice = 0;                                                  // its niceness, unless this process's is higher
  int threads = 1;  // value of OMP_NUM_THREADS and the like in the child's environment
};

struct ChildResult {
  enum class Outcome { kExited, kSignalled, kTimedOut, kCancelled, kNotStarted };
  Outcome outcome = Outcome::kNotStarted;
  int exit_code = 0;             // the program's exit code, if outcome is kExited
  int signal = 0;                // signal that ended the program, if outcome is kSignalled
  bool was_idle = false;         // if outcome is kTimedOut: true if idle_limit_s was reached
  double wall_s = 0, cpu_s = 0;  // cpu_s includes the children that the program waited for
  std::string last_output;       // the end of its output, at most 16 KiB
  bool ok() const { return outcome == Outcome::kExited && exit_code == 0; }
  std::string describe() const;  // "killed by signal 9 (Killed)", "colmap: not found in PATH; install ...", ...
  std::string error;             // reason, if outcome is kNotStarted
};

// Runs the command and blocks until it has ended. The child has a process group of its own. If a limit is reached or
// `cancel` becomes true, the whole group gets SIGTERM, and SIGKILL a second later. What is left of the group when its
// first process has ended is killed. The first process dies with the calling thread (PR_SET_PDEATHSIG).
ChildResult run_child(const ChildCommand& command, const std::atomic<bool>& cancel);

}  // namespace rumi
