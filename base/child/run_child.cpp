// SPDX-License-Identifier: BSD-3-Clause
#include "base/child/run_child.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/syscall.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <optional>
#include <string_view>
#include <utility>

#include "base/child/child_process.h"

namespace rumi {
namespace {

using Clock = std::chrono::steady_clock;
using Outcome = ChildResult::Outcome;

constexpr size_t kLastOutputBytes = 16384;
constexpr int kPollMs = 20;       // how soon `cancel` is noticed, at the latest
constexpr double kGraceS = 1;     // time from SIGTERM to SIGKILL
constexpr int kLastBuffers = 16;  // buffers read after the child's end, at most: a process that left the group may
                                  // write for ever

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Reads the child's output, writes its beginning to the log and keeps its end.
class Output {
 public:
  Output(Child* child, FileDescriptor log, const ChildCommand& command)
      : child_(child), log_(std::move(log)), log_left_(command.log_limit_bytes), on_output_(command.on_output) {}
  // Reads at most one buffer, so that a child that never pauses cannot keep supervise() from looking at the clock.
  // Returns false if there was nothing to read.
  bool take() {
    std::array<char, 65536> buffer;  // as much as a pipe holds
    const ssize_t count = read(child_->output(), buffer.data(), buffer.size());
    if (count == 0) child_->close_output();  // closed by the child, which may go on running
    if (count <= 0) return false;
    const std::string_view text(buffer.data(), static_cast<size_t>(count));
    log(text);
    if (on_output_) on_output_(text);
    last_.append(text);
    if (last_.size() > kLastOutputBytes) last_.erase(0, last_.size() - kLastOutputBytes);
    return true;
  }
  const std::string& last() const { return last_; }

 private:
  void log(std::string_view text) {
    if (log_left_ == 0) return;
    const size_t kept = std::min(text.size(), log_left_);
    log_left_ -= kept;
    write_log(text.substr(0, kept));
    if (log_left_ == 0) write_log("\n[the rest is left out: the log has reached its size limit]\n");
  }
  // Stops logging if the log cannot be written (disk full): that is no reason to stop the child.
  void write_log(std::string_view text) {
    while (log_.get() >= 0 && !text.empty()) {
      const ssize_t count = write(log_.get(), text.data(), text.size());
      if (count < 0 && errno != EINTR) return log_.reset();
      if (count > 0) text.remove_prefix(static_cast<size_t>(count));
    }
  }

  Child* child_;
  FileDescriptor log_;
  size_t log_left_;
  const std::function<void(std::string_view)>& on_output_;
  std::string last_;
};

// Returns the CPU seconds that the process has used so far, or 0 if it has ended.
double cpu_s_of(pid_t child) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Measures how long the child has printed nothing and used hardly any CPU time.
class Idleness {
 public:
  explicit Idleness(Clock::time_point now) : since_(now) {}
  double seconds(double cpu_s, bool said_something) {
    if (said_something || cpu_s - cpu_s_ >= kSignOfLifeS) {
      since_ = Clock::now();
      cpu_s_ = cpu_s;
    }
    return seconds_since(since_);
  }

 private:
  static constexpr double kSignOfLifeS = 0.05;  // CPU time that counts as work; a window that waits to be closed uses
                                                // less
  Clock::time_point since_;
  double cpu_s_ = 0;
};

// Waits until the child ends, and ends it when a limit is reached or `cancel` is set.
Outcome supervise(const Child& child, const ChildCommand& command, const std::atomic<bool>& cancel, Output* output,
                  bool* was_idle) {
  const Clock::time_point start = Clock::now();
  // This is -1 on a kernel before 5.3: then the child's end is noticed by the next poll.
  const FileDescriptor end(static_cast<int>(syscall(SYS_pidfd_open, child.pid(), 0)));
  Outcome outcome = Outcome::kExited;
  Idleness idleness(start);
  std::optional<Clock::time_point> asked;
  while (!child.has_ended()) {
    std::array<pollfd, 2> wanted{{{end.get(), POLLIN, 0}, {child.output(), POLLIN, 0}}};
    poll(wanted.data(), wanted.size(), kPollMs);
    const bool said_something = wanted[1].revents != 0 && output->take();
    if (!asked) {
      const double cpu_s = cpu_s_of(child.pid());
      *was_idle = idleness.seconds(cpu_s, said_something) >= command.idle_limit_s;
      if (cancel)
        outcome = Outcome::kCancelled;
      else if (*was_idle || seconds_since(start) >= command.time_limit_s || cpu_s >= command.cpu_limit_s)
        outcome = Outcome::kTimedOut;
      if (outcome == Outcome::kExited) continue;
      asked = Clock::now();
      child.send_to_group(SIGTERM);
    } else if (seconds_since(*asked) >= kGraceS) {
      child.send_to_group(SIGKILL);
    }
  }
  return outcome;
}

void note_end(const ChildEnd& end, ChildResult* result) {
  result->cpu_s = end.cpu_s;
  if (result->outcome != Outcome::kExited) return;
  if (!end.is_known) {
    result->outcome = Outcome::kNotStarted;
    result->error = end.describe();
  } else if (end.signalled()) {
    result->outcome = Outcome::kSignalled;
    result->signal = end.signal();
  } else {
    result->exit_code = end.exit_code();
  }
}

ChildLaunch launch_of(const ChildCommand& command) {
  ChildLaunch launch{command.arguments, command.environment, command.nice, SIGKILL};
  for (const char* name : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"})
    launch.environment.push_back(fmt::format("{}={}", name, command.threads));
  return launch;
}

ChildResult not_started(const std::string& error) {
  ChildResult result;
  result.error = error;
  return result;
}

}  // namespace

std::string ChildResult::describe() const {
  switch (outcome) {
    case Outcome::kExited:
      return exit_code == 0 ? "ended well" : fmt::format("ended with exit code {}", exit_code);
    case Outcome::kSignalled:
      return fmt::format("killed by signal {} ({})", signal, strsignal(signal));
    case Outcome::kTimedOut:
      if (was_idle) return fmt::format("stopped after {:.1f} s, as it did nothing", wall_s);
      return fmt::format("stopped at its time limit, after {:.1f} s ({:.1f} s of CPU time)", wall_s, cpu_s);
    case Outcome::kCancelled:
      return "cancelled";
    case Outcome::kNotStarted:
      return error;
  }
  return {};
}

ChildResult run_child(const ChildCommand& command, const std::atomic<bool>& cancel) {
  ChildResult result;
  if (cancel) {
    result.outcome = Outcome::kCancelled;
    return result;
  }
  FileDescriptor log;
  if (!command.log_file.empty()) {
    log = FileDescriptor(open(command.log_file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666));
    if (!log || !log.move_above_stdio())
      return not_started(fmt::format("{}: {}", command.log_file, std::strerror(errno)));
  }
  const Clock::time_point start = Clock::now();
  Result<Child> child = Child::start(launch_of(command));
  if (!child) return not_started(child.error_text());
  Output output(&*child, std::move(log), command);
  result.outcome = supervise(*child, command, cancel, &output, &result.was_idle);
  note_end(child->reap(), &result);
  for (int i = 0; i < kLastBuffers && output.take(); ++i) {
  }
  result.wall_s = seconds_since(start);
  result.last_output = output.last();
  return result;
}

}  // namespace rumi
