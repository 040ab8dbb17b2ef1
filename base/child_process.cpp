// SPDX-License-Identifier: BSD-3-Clause
// fork and exec with nothing but async-signal-safe calls between them, because this process has threads (LCM's). Not
// posix_spawn: it can set neither the niceness nor PR_SET_PDEATHSIG.
#include "base/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/close_range.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <optional>
#include <string_view>
#include <utility>

namespace rumi {
namespace {

using Clock = std::chrono::steady_clock;
using Outcome = ChildResult::Outcome;

constexpr size_t kLastOutputBytes = 16384;
constexpr int kPollMs = 20;        // how soon `cancel` is seen
constexpr double kGraceS = 1;      // from SIGTERM to SIGKILL
constexpr int kLastBuffers = 16;   // read after its end; not more: a process that left the group may write for ever
constexpr int kNotExecuted = 127;  // as a shell would say; the reason comes through the pipe

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::string error_text(int code) { return std::strerror(code); }

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { reset(); }
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  int get() const { return fd_; }
  void reset() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }
  // In a process that was started without stdin or stdout, a new descriptor may be one of 0 to 2, which the child
  // replaces.
  bool move_above_stdio() {
    if (fd_ < 0 || fd_ > STDERR_FILENO) return fd_ >= 0;
    Descriptor moved(fcntl(fd_, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
    std::swap(fd_, moved.fd_);
    return fd_ >= 0;
  }

 private:
  int fd_ = -1;
};

struct Pipe {
  Descriptor read, write;
  bool open() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return false;
    read = Descriptor(ends[0]);
    write = Descriptor(ends[1]);
    return read.move_above_stdio() && write.move_above_stdio();
  }
};

// The file to execute, or nothing. A name with a slash is not searched for.
std::optional<std::string> find_program(const std::string& name) {
  if (name.find('/') != std::string::npos) return name;
  const char* variable = std::getenv("PATH");
  const std::string path = variable ? variable : "/usr/local/bin:/usr/bin:/bin";
  for (size_t begin = 0; begin <= path.size();) {
    const size_t end = std::min(path.find(':', begin), path.size());
    const std::string folder = path.substr(begin, end - begin);
    const std::string file = (folder.empty() ? "." : folder) + "/" + name;
    struct stat info {};
    if (stat(file.c_str(), &info) == 0 && S_ISREG(info.st_mode) && access(file.c_str(), X_OK) == 0) return file;
    begin = end + 1;
  }
  return std::nullopt;
}

// Ours, with `settings` (NAME=value) instead of what ours says of the same names.
std::vector<std::string> environment_with(const std::vector<std::string>& settings) {
  std::vector<std::string> all = settings;
  for (char** entry = environ; entry && *entry; ++entry) {
    const std::string_view ours = *entry;
    const std::string_view name = ours.substr(0, ours.find('=') + 1);
    const bool replaced = std::any_of(settings.begin(), settings.end(),
                                      [&](const std::string& s) { return !name.empty() && s.starts_with(name); });
    if (!replaced) all.emplace_back(ours);
  }
  return all;
}

std::vector<std::string> child_environment(const ChildCommand& command) {
  std::vector<std::string> settings = command.environment;
  for (const char* name : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"})
    settings.push_back(fmt::format("{}={}", name, command.threads));
  return environment_with(settings);
}

std::vector<char*> pointers(std::vector<std::string>& strings) {
  std::vector<char*> list;
  list.reserve(strings.size() + 1);
  for (std::string& s : strings) list.push_back(s.data());
  list.push_back(nullptr);
  return list;
}

// All that the child needs, made before the fork: the child must not allocate.
struct Launch {
  std::string program;
  std::vector<std::string> arguments, environment;
  std::vector<char*> argv, envp;
  int nice = 0;
  int descriptor_limit = 0;
  pid_t parent = 0;
  sigset_t signals{};  // to be blocked in the child as they were in the parent before the fork
  Descriptor input;
  Pipe output, failure;
};

// Between fork and exec: async-signal-safe calls only.
[[noreturn]] void become_program(const Launch& launch) {
  const auto give_up = [&](int reason) {
    [[maybe_unused]] const ssize_t written = write(launch.failure.write.get(), &reason, sizeof(reason));
    _exit(kNotExecuted);
  };
  // What the parent ignores would stay ignored.
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  for (int signal = 1; signal < NSIG; ++signal) sigaction(signal, &standard, nullptr);
  sigemptyset(&standard.sa_mask);
  sigprocmask(SIG_SETMASK, &standard.sa_mask, nullptr);

  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) give_up(errno);
  if (getppid() != launch.parent) _exit(kNotExecuted);  // it died before that
  if (setpgid(0, 0) != 0) give_up(errno);
  setpriority(PRIO_PROCESS, 0, launch.nice);  // never lower than ours, so always granted
  if (dup2(launch.input.get(), STDIN_FILENO) < 0) give_up(errno);
  if (dup2(launch.output.write.get(), STDOUT_FILENO) < 0) give_up(errno);
  if (dup2(launch.output.write.get(), STDERR_FILENO) < 0) give_up(errno);
  // Closed by exec: until then the pipe for failures is needed. Kernels before 5.11 do not know it.
  if (close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC) != 0)
    for (int fd = STDERR_FILENO + 1; fd < launch.descriptor_limit; ++fd) fcntl(fd, F_SETFD, FD_CLOEXEC);
  execve(launch.program.c_str(), launch.argv.data(), launch.envp.data());
  give_up(errno);
  _exit(kNotExecuted);
}

// Forks with all signals blocked: a signal meant for this process must not run its handlers in the child.
pid_t fork_program(const Launch& launch) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t child = fork();
  if (child == 0) become_program(launch);
  const int reason = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = reason;
  return child;
}

// Why the program could not be executed, 0 when it is running. Ends when exec has closed the pipe.
int execution_failure(const Pipe& failure) {
  int reason = 0;
  ssize_t count = 0;
  do count = read(failure.read.get(), &reason, sizeof(reason));
  while (count < 0 && errno == EINTR);
  return count == sizeof(reason) ? reason : 0;
}

// What the child says: the beginning goes into the log, the end is remembered.
class Output {
 public:
  Output(Descriptor pipe, Descriptor log, const ChildCommand& command)
      : pipe_(std::move(pipe)),
        log_(std::move(log)),
        log_left_(command.log_limit_bytes),
        on_output_(command.on_output) {
    fcntl(pipe_.get(), F_SETFL, O_NONBLOCK);
  }
  int descriptor() const { return pipe_.get(); }
  // Takes at most one buffer, so that a child that never pauses cannot keep us from looking at the clock. False: there
  // was nothing to take.
  bool take() {
    std::array<char, 65536> buffer;  // as much as a pipe holds
    const ssize_t count = read(pipe_.get(), buffer.data(), buffer.size());
    if (count == 0) pipe_.reset();  // closed by the child, which may live on
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
  // A log that cannot be written (disk full) is no reason to stop the child.
  void write_log(std::string_view text) {
    while (log_.get() >= 0 && !text.empty()) {
      const ssize_t count = write(log_.get(), text.data(), text.size());
      if (count < 0 && errno != EINTR) return log_.reset();
      if (count > 0) text.remove_prefix(static_cast<size_t>(count));
    }
  }

  Descriptor pipe_, log_;
  size_t log_left_;
  const std::function<void(std::string_view)>& on_output_;
  std::string last_;
};

bool has_ended(pid_t child) {
  siginfo_t info{};
  // The child is left waitable: while it is, neither its id nor its group's can belong to anyone else.
  return waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid == child;
}

// 0 when it has ended.
double cpu_s_of(pid_t child) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Waits for the child's end, and brings it about when the time is up or `cancel` is set.
Outcome supervise(pid_t child, const ChildCommand& command, const std::atomic<bool>& cancel, Output* output) {
  const Clock::time_point start = Clock::now();
  // -1 on a kernel before 5.3: then the end is seen at the next poll.
  const Descriptor end(static_cast<int>(syscall(SYS_pidfd_open, child, 0)));
  Outcome outcome = Outcome::kExited;
  std::optional<Clock::time_point> asked;
  while (!has_ended(child)) {
    std::array<pollfd, 2> wanted{{{end.get(), POLLIN, 0}, {output->descriptor(), POLLIN, 0}}};
    poll(wanted.data(), wanted.size(), kPollMs);
    if (wanted[1].revents != 0) output->take();
    if (!asked) {
      if (cancel)
        outcome = Outcome::kCancelled;
      else if (seconds_since(start) >= command.time_limit_s || cpu_s_of(child) >= command.cpu_limit_s)
        outcome = Outcome::kTimedOut;
      if (outcome == Outcome::kExited) continue;
      asked = Clock::now();
      kill(-child, SIGTERM);
    } else if (seconds_since(*asked) >= kGraceS) {
      kill(-child, SIGKILL);
    }
  }
  kill(-child, SIGKILL);  // whatever it started and left behind
  return outcome;
}

double seconds(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

void reap(pid_t child, ChildResult* result) {
  int status = 0;
  rusage usage{};
  pid_t reaped = 0;
  do reaped = wait4(child, &status, 0, &usage);
  while (reaped < 0 && errno == EINTR);
  result->cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  if (result->outcome != Outcome::kExited) return;
  if (reaped != child) {
    result->outcome = Outcome::kNotStarted;
    result->error = "its exit status was taken by another part of this process (is SIGCHLD ignored?)";
  } else if (WIFSIGNALED(status)) {
    result->outcome = Outcome::kSignalled;
    result->signal = WTERMSIG(status);
  } else {
    result->exit_code = WEXITSTATUS(status);
  }
}

// What went wrong, or an empty string.
std::string prepare(const ChildCommand& command, Launch* launch, Descriptor* log) {
  const std::string& name = command.arguments.front();
  const std::optional<std::string> program = find_program(name);
  if (!program) return fmt::format("{}: not found in PATH; install it, or give its path", name);
  launch->program = *program;
  launch->arguments = command.arguments;
  launch->environment = child_environment(command);
  launch->argv = pointers(launch->arguments);
  launch->envp = pointers(launch->environment);
  launch->nice = std::max(command.nice, getpriority(PRIO_PROCESS, 0));
  launch->descriptor_limit = static_cast<int>(sysconf(_SC_OPEN_MAX));
  launch->parent = getpid();
  if (!command.log_file.empty()) {
    *log = Descriptor(open(command.log_file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666));
    if (log->get() < 0) return fmt::format("{}: {}", command.log_file, error_text(errno));
  }
  launch->input = Descriptor(open("/dev/null", O_RDONLY | O_CLOEXEC));
  if (!launch->input.move_above_stdio() || !launch->output.open() || !launch->failure.open())
    return fmt::format("{}: cannot be started: {}", name, error_text(errno));
  return {};
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
      return fmt::format("stopped at its time limit, after {:.1f} s ({:.1f} s of CPU time)", wall_s, cpu_s);
    case Outcome::kCancelled:
      return "cancelled";
    case Outcome::kNotStarted:
      return error;
  }
  return {};
}

ChildResult run_child(const ChildCommand& command, const std::atomic<bool>& cancel) {
  if (command.arguments.empty() || command.arguments.front().empty()) return not_started("no program is named");
  ChildResult result;
  if (cancel) {
    result.outcome = Outcome::kCancelled;
    return result;
  }
  Launch launch;
  Descriptor log;
  const std::string problem = prepare(command, &launch, &log);
  if (!problem.empty()) return not_started(problem);

  const Clock::time_point start = Clock::now();
  const pid_t child = fork_program(launch);
  if (child < 0)
    return not_started(fmt::format("{}: cannot be started: {}", command.arguments.front(), error_text(errno)));
  launch.failure.write.reset();
  launch.output.write.reset();
  if (const int reason = execution_failure(launch.failure); reason != 0) {
    reap(child, &result);
    return not_started(fmt::format("{}: cannot be executed: {}", launch.program, error_text(reason)));
  }
  Output output(std::move(launch.output.read), std::move(log), command);
  result.outcome = supervise(child, command, cancel, &output);
  reap(child, &result);
  for (int i = 0; i < kLastBuffers && output.take(); ++i) {
  }
  result.wall_s = seconds_since(start);
  result.last_output = output.last();
  return result;
}

}  // namespace rumi
