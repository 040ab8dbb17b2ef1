// SPDX-License-Identifier: BSD-3-Clause
// Starts another program and reports how it ended.
#pragma once

#include <signal.h>
#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

#include "base/files/file_descriptor.h"
#include "base/result.h"

namespace rumi {

struct ChildLaunch {
  std::vector<std::string> arguments;    // the program (found in PATH, or a path) and its arguments
  std::vector<std::string> environment;  // NAME=value; replaces or adds to the variables of this process's environment
  int nice = 0;                          // its niceness, unless this process's is higher
  int death_signal = SIGKILL;            // sent to the child when the thread that started it ends
  std::vector<int> held_signals = {};    // signals that stay blocked in the child until the program is ready and
                                         // unblocks them
};

// How a process ended, as waitpid() reports it.
struct ChildEnd {
  int status = 0;
  double cpu_s = 0;       // includes the children that the process waited for
  bool is_known = false;  // false: another part of this process took its exit status, or SIGCHLD is ignored

  bool exited() const;
  int exit_code() const;
  bool signalled() const;
  int signal() const;
  std::string describe() const;  // "ended with exit code 3", "was ended by signal 9 (Killed)"
};

// A running program. It has a process group of its own: whatever it starts can be ended with it, and a Ctrl-C in the
// terminal does not reach it. It inherits no descriptors, reads from /dev/null, writes stdout and stderr to output(),
// and starts with the default signal handlers.
class Child {
 public:
  // Returns an Error if the program cannot be executed.
  static Result<Child> start(const ChildLaunch& launch);
  Child(Child&& other) noexcept : pid_(std::exchange(other.pid_, 0)), output_(std::move(other.output_)) {}
  Child& operator=(Child&& other) noexcept;
  ~Child();  // kills the program and its process group, unless reap() was called

  pid_t pid() const { return pid_; }
  // The read end of the pipe that the program writes stdout and stderr to. Reading does not block. -1 once it is
  // closed.
  int output() const { return output_.get(); }
  void close_output() { output_.reset(); }
  // Does not reap the process: until reap() no other process can get its id or the id of its group.
  bool has_ended() const;
  void send(int signal) const { kill(pid_, signal); }
  void send_to_group(int signal) const { kill(-pid_, signal); }
  // Waits until the program ends and kills the processes that it left behind. To be called once.
  ChildEnd reap();

 private:
  Child(pid_t pid, FileDescriptor output) : pid_(pid), output_(std::move(output)) {}

  pid_t pid_ = 0;  // 0 after reap()
  FileDescriptor output_;
};

}  // namespace rumi
