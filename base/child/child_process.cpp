// SPDX-License-Identifier: BSD-3-Clause
// Only async-signal-safe calls stand between fork and exec, because this process has threads (LCM's). posix_spawn is no
// alternative: it can set neither the niceness nor PR_SET_PDEATHSIG.
#include "base/child/child_process.h"

#include <fmt/format.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>

namespace rumi {
namespace {

constexpr int kNotExecuted = 127;  // exit code if exec fails, as of a shell; the errno comes through the pipe `failure`

std::string error_text(int code) { return std::strerror(code); }

struct Pipe {
  FileDescriptor read, write;
  bool open() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return false;
    read = FileDescriptor(ends[0]);
    write = FileDescriptor(ends[1]);
    return read.move_above_stdio() && write.move_above_stdio();
  }
};

// Returns the file to execute; nullopt if PATH has none. A name with a slash is a path and is not searched for.
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

// Returns this process's environment, in which `settings` (NAME=value) replace the variables of the same names.
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

std::vector<char*> pointers(std::vector<std::string>& strings) {
  std::vector<char*> list;
  list.reserve(strings.size() + 1);
  for (std::string& s : strings) list.push_back(s.data());
  list.push_back(nullptr);
  return list;
}

// Everything that the child needs, allocated before the fork: the child must not allocate.
struct Prepared {
  std::string program;
  std::vector<std::string> arguments, environment;
  std::vector<char*> argv, envp;
  int nice = 0;
  int death_signal = SIGKILL;
  sigset_t held_signals{};
  int descriptor_limit = 0;
  pid_t parent = 0;
  FileDescriptor input;
  Pipe output, failure;
};

// Runs between fork and exec, where only async-signal-safe calls are allowed.
[[noreturn]] void become_program(const Prepared& launch) {
  const auto give_up = [&](int reason) {
    [[maybe_unused]] const ssize_t written = write(launch.failure.write.get(), &reason, sizeof(reason));
    _exit(kNotExecuted);
  };
  // Without this, signals that the parent ignores would stay ignored.
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  for (int signal = 1; signal < NSIG; ++signal) sigaction(signal, &standard, nullptr);
  sigprocmask(SIG_SETMASK, &launch.held_signals, nullptr);

  if (prctl(PR_SET_PDEATHSIG, launch.death_signal) != 0) give_up(errno);
  if (getppid() != launch.parent) _exit(kNotExecuted);  // the parent died before prctl()
  if (setpgid(0, 0) != 0) give_up(errno);
  setpriority(PRIO_PROCESS, 0, launch.nice);  // never lower than the parent's, so always allowed
  if (dup2(launch.input.get(), STDIN_FILENO) < 0) give_up(errno);
  if (dup2(launch.output.write.get(), STDOUT_FILENO) < 0) give_up(errno);
  if (dup2(launch.output.write.get(), STDERR_FILENO) < 0) give_up(errno);
  // Lets exec close the other descriptors, because the pipe for failures is needed until then. Kernels before 5.11 do
  // not know CLOSE_RANGE_CLOEXEC.
  if (close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC) != 0)
    for (int fd = STDERR_FILENO + 1; fd < launch.descriptor_limit; ++fd) fcntl(fd, F_SETFD, FD_CLOEXEC);
  execve(launch.program.c_str(), launch.argv.data(), launch.envp.data());
  give_up(errno);
  _exit(kNotExecuted);
}

// Blocks all signals while it forks: a signal for this process must not run its handlers in the child.
pid_t fork_program(const Prepared& launch) {
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

// Returns the errno of the failed exec, or 0 if the program runs. Blocks until exec has closed the pipe.
int execution_failure(const Pipe& failure) {
  int reason = 0;
  ssize_t count = 0;
  do count = read(failure.read.get(), &reason, sizeof(reason));
  while (count < 0 && errno == EINTR);
  return count == sizeof(reason) ? reason : 0;
}

Result<> prepare(const ChildLaunch& wanted, Prepared* launch) {
  if (wanted.arguments.empty() || wanted.arguments.front().empty()) return Error{"no program is named"};
  const std::string& name = wanted.arguments.front();
  const std::optional<std::string> program = find_program(name);
  if (!program) return Error{"not found in PATH", name, "install it, or give its path"};
  launch->program = *program;
  launch->arguments = wanted.arguments;
  launch->environment = environment_with(wanted.environment);
  launch->argv = pointers(launch->arguments);
  launch->envp = pointers(launch->environment);
  launch->nice = std::max(wanted.nice, getpriority(PRIO_PROCESS, 0));
  launch->death_signal = wanted.death_signal;
  sigemptyset(&launch->held_signals);
  for (const int signal : wanted.held_signals) sigaddset(&launch->held_signals, signal);
  launch->descriptor_limit = static_cast<int>(sysconf(_SC_OPEN_MAX));
  launch->parent = getpid();
  launch->input = FileDescriptor(open("/dev/null", O_RDONLY | O_CLOEXEC));
  if (!launch->input.move_above_stdio() || !launch->output.open() || !launch->failure.open())
    return Error{"cannot be started: " + error_text(errno), name};
  return {};
}

double seconds(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

}  // namespace

bool ChildEnd::exited() const { return is_known && WIFEXITED(status); }
int ChildEnd::exit_code() const { return WEXITSTATUS(status); }
bool ChildEnd::signalled() const { return is_known && WIFSIGNALED(status); }
int ChildEnd::signal() const { return WTERMSIG(status); }

std::string ChildEnd::describe() const {
  if (exited()) return fmt::format("ended with exit code {}", exit_code());
  if (signalled()) return fmt::format("was ended by signal {} ({})", signal(), strsignal(signal()));
  return "ended, and another part of this process took its exit status (is SIGCHLD ignored?)";
}

Result<Child> Child::start(const ChildLaunch& launch) {
  Prepared prepared;
  if (const Result<> ready = prepare(launch, &prepared); !ready) return ready.error();
  const pid_t pid = fork_program(prepared);
  if (pid < 0) return Error{"cannot be started: " + error_text(errno), launch.arguments.front()};
  prepared.failure.write.reset();
  prepared.output.write.reset();
  Child child(pid, std::move(prepared.output.read));
  if (const int reason = execution_failure(prepared.failure); reason != 0) {
    child.reap();
    return Error{"cannot be executed: " + error_text(reason), prepared.program};
  }
  fcntl(child.output(), F_SETFL, O_NONBLOCK);
  return child;
}

Child& Child::operator=(Child&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(output_, other.output_);
  return *this;
}

Child::~Child() {
  if (pid_ <= 0) return;
  send_to_group(SIGKILL);
  reap();
}

bool Child::has_ended() const {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid == pid_;
}

ChildEnd Child::reap() {
  siginfo_t info{};
  while (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
  }
  send_to_group(SIGKILL);
  ChildEnd end;
  rusage usage{};
  pid_t reaped = 0;
  do reaped = wait4(pid_, &end.status, 0, &usage);
  while (reaped < 0 && errno == EINTR);
  end.is_known = reaped == pid_;
  end.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  pid_ = 0;
  return end;
}

}  // namespace rumi
