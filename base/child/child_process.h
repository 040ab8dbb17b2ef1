// SPDX-License-Identifier: BSD-3-Clause
// Starts another program, and tells when it ends.
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
  std::vector<std::string> environment;  // NAME=value, besides ours
  int nice = 0;                          // our niceness, if that is higher
  int death_signal = SIGKILL;            // sent to the child when the thread that started it ends
  std::vector<int> held_signals = {};    // wait until the program unblocks them: it may not handle them at once
};

// How a process ended, as waitpid() tells.
struct ChildEnd {
  int status = 0;
  double cpu_s = 0;       // includes the children that it waited for
  bool is_known = false;  // false: another part of this process took its status (SIGCHLD is ignored?)

  bool exited() const;
  int exit_code() const;
  bool signalled() const;
  int signal() const;
  std::string describe() const;  // "ended with exit code 3", "was ended by signal 9 (Killed)"
};

// A running program. It has a process group of its own, so that whatever it starts can be ended with it, and so that a
// Ctrl-C in the terminal reaches only us. It inherits no descriptor, reads from /dev/null, writes both outputs to us,
// and starts with default signal handling.
class Child {
 public:
  // An Error if the program cannot be executed.
  static Result<Child> start(const ChildLaunch& launch);
  Child(Child&& other) noexcept : pid_(std::exchange(other.pid_, 0)), output_(std::move(other.output_)) {}
  Child& operator=(Child&& other) noexcept;
  ~Child();  // kills it and its group

  pid_t pid() const { return pid_; }
  // Our end of what it writes, which does not block; -1 once it is closed.
  int output() const { return output_.get(); }
  void close_output() { output_.reset(); }
  // Does not reap it: until reap() no other process can get its id or its group's id.
  bool has_ended() const;
  void send(int signal) const { kill(pid_, signal); }
  void send_to_group(int signal) const { kill(-pid_, signal); }
  // Waits for its end and kills the processes that it left behind. To be called once.
  ChildEnd reap();

 private:
  Child(pid_t pid, FileDescriptor output) : pid_(pid), output_(std::move(output)) {}

  pid_t pid_ = 0;  // 0: reaped
  FileDescriptor output_;
};

}  // namespace rumi
