// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/supervisor.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>

namespace rumi::tool {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLook{50};          // how often deaths are looked for
constexpr milliseconds kAskToFinish{500};  // so often, and not before it has had time to install a handler
constexpr size_t kLongestLine = 16384;     // a longer one is cut
constexpr int kWrongCommandLine = 2;       // exit code of all Rumi processes: starting again would not help

std::string describe_status(int status) {
  if (WIFEXITED(status)) return fmt::format("ended with exit code {}", WEXITSTATUS(status));
  if (WIFSIGNALED(status))
    return fmt::format("was ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  return fmt::format("ended with status {}", status);
}

// True if a thread of the process has a CPU, waits for one, or for a disk; on a busy machine work may get little CPU
// time.
bool is_at_work(pid_t pid) {
  std::error_code error;
  const std::string threads = fmt::format("/proc/{}/task", pid);
  for (std::filesystem::directory_iterator it(threads, error), end; !error && it != end; it.increment(error)) {
    std::string text;
    std::getline(std::ifstream(it->path() / "stat"), text);
    const size_t name_end = text.rfind(')');  // the state follows
    if (name_end == std::string::npos || name_end + 2 >= text.size()) continue;
    if (const char state = text[name_end + 2]; state == 'R' || state == 'D') return true;
  }
  return false;
}

// With processes that were asked to end: while any of all that run is at work, which the others may be waiting for.
class Patience {
 public:
  explicit Patience(const SupervisorOptions& options) : options_(options) {}

  // Call every kLook. Returns why it is over, or an empty string.
  std::string end(bool one_is_at_work) {
    const auto now = Clock::now();
    seen_at_work_ += one_is_at_work;
    if (++looks_ == kLooks) {
      if (seen_at_work_ >= kSeenAtWork) last_work_ = now;
      looks_ = seen_at_work_ = 0;
    }
    const auto seconds = [](auto duration) { return std::chrono::duration<double>(duration).count(); };
    if (now - last_work_ >= options_.stop_idle)
      return fmt::format("nothing was done for {:.1f} s", seconds(now - last_work_));
    if (now - begin_ >= options_.stop_limit) return fmt::format("still at work after {:.0f} s", seconds(now - begin_));
    return {};
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int kLooks = 6, kSeenAtWork = 3;  // who only waits is awake for a moment now and then
  const SupervisorOptions& options_;
  const Clock::time_point begin_ = Clock::now();
  Clock::time_point last_work_ = begin_;
  int looks_ = 0, seen_at_work_ = 0;
};

// In the child. Only async-signal-safe calls; the supervisor has one thread, so fork() is safe, and unlike posix_spawn
// it lets the child ask to be told when the supervisor is killed.
[[noreturn]] void execute(char* const* argv, int output, pid_t parent) {
  setpgid(0, 0);  // Ctrl-C in a terminal is the supervisor's to handle
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const int null = open("/dev/null", O_RDONLY);
  dup2(null, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  execv(argv[0], argv);
  const char* reason = strerror(errno);
  if (write(STDERR_FILENO, "cannot be started: ", 19) < 0 || write(STDERR_FILENO, reason, strlen(reason)) < 0)
    _exit(127);
  _exit(127);
}

}  // namespace

Supervisor::Supervisor(std::vector<ChildProcess> children, const SupervisorOptions& options, LineHandler on_line)
    : options_(options), on_line_(std::move(on_line)) {
  for (ChildProcess& process : children) {
    Child child;
    child.process = std::move(process);
    child.delay = options_.restart_delay;
    children_.push_back(std::move(child));
  }
}

Supervisor::~Supervisor() {
  for (Child& child : children_) {
    if (child.pid > 0) {
      kill(-child.pid, SIGKILL);
      waitpid(child.pid, nullptr, 0);
    }
    if (child.output >= 0) close(child.output);
  }
}

bool Supervisor::start(Child& child) {
  std::vector<char*> argv;
  for (std::string& argument : child.process.command) argv.push_back(argument.data());
  argv.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) return false;
  fcntl(ends[1], F_SETFL, 0);  // the child must wait when we are slow to read, not lose output
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) execute(argv.data(), ends[1], parent);
  close(ends[1]);
  if (pid < 0) {
    close(ends[0]);
    return false;
  }
  setpgid(pid, pid);  // in both, so that it holds whoever is first
  child.pid = pid;
  child.output = ends[0];
  child.started = Clock::now();
  return true;
}

void Supervisor::drain(Child& child) {
  char buffer[4096];
  for (ssize_t n; child.output >= 0 && (n = read(child.output, buffer, sizeof(buffer))) > 0;) {
    child.partial.append(buffer, static_cast<size_t>(n));
    size_t begin = 0;
    for (size_t end; (end = child.partial.find('\n', begin)) != std::string::npos; begin = end + 1) {
      on_line_(child.process.name, child.partial.substr(begin, end - begin));
    }
    child.partial.erase(0, begin);
    if (child.partial.size() > kLongestLine) {
      on_line_(child.process.name, child.partial);
      child.partial.clear();
    }
  }
}

void Supervisor::read_output(milliseconds timeout) {
  std::vector<pollfd> fds;
  for (const Child& child : children_) {
    if (child.output >= 0) fds.push_back({child.output, POLLIN, 0});
  }
  const auto begin = Clock::now();
  poll(fds.data(), fds.size(), static_cast<int>(timeout.count()));
  for (Child& child : children_) drain(child);
  // A pipe at its end is always ready: without a rest, waiting for its process's death would be a busy loop.
  const bool hung_up = std::any_of(fds.begin(), fds.end(), [](const pollfd& fd) { return fd.revents & POLLHUP; });
  if (hung_up && Clock::now() - begin < timeout / 2) usleep(5000);
}

bool Supervisor::reap(Child& child, int* status) {
  if (child.pid <= 0 || waitpid(child.pid, status, WNOHANG) != child.pid) return false;
  kill(-child.pid, SIGKILL);  // what it may have left behind, such as COLMAP
  drain(child);
  if (!child.partial.empty()) on_line_(child.process.name, child.partial);
  child.partial.clear();
  close(child.output);
  child.output = -1;
  child.pid = 0;
  return true;
}

// Returns why everything must be given up, or plans a restart.
std::string Supervisor::on_death(Child& child, int status) {
  const std::string what = fmt::format("{} {}", child.process.name, describe_status(status));
  if (WIFEXITED(status) && WEXITSTATUS(status) == kWrongCommandLine) return what + ": wrong command line or options";
  const auto now = Clock::now();
  child.failed_starts = now - child.started < options_.failed_start ? child.failed_starts + 1 : 0;
  if (child.failed_starts >= options_.max_failed_starts) {
    return fmt::format("{}, {} times in a row right after its start", what, child.failed_starts);
  }
  if (now - child.started > options_.restart_delay_max) child.delay = options_.restart_delay;
  say(fmt::format("{}; starting it again in {:.1f} s", what, static_cast<double>(child.delay.count()) * 1e-3));
  child.restart_at = now + child.delay;
  child.delay = std::min(2 * child.delay, options_.restart_delay_max);
  return "";
}

std::string Supervisor::watch(bool* source_ended) {
  for (Child& child : children_) {
    int status = 0;
    if (child.is_beside) continue;
    if (reap(child, &status)) {
      if (child.process.source && WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        *source_ended = child.finished = true;
        continue;
      }
      if (finishing_ && child.process.finishes && WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        child.finished = true;
        continue;
      }
      if (std::string reason = on_death(child, status); !reason.empty()) return reason;
    } else if (child.pid == 0 && !child.finished && Clock::now() >= child.restart_at) {
      const bool again = child.started != Clock::time_point();
      if (!start(child)) return fmt::format("{} cannot be started: {}", child.process.name, strerror(errno));
      restarts_ += again;
    }
  }
  return "";
}

void Supervisor::kill_child(Child& child) {
  kill(-child.pid, SIGKILL);
  int status = 0;
  while (!reap(child, &status)) usleep(1000);
}

void Supervisor::stop_those(const std::function<bool(const ChildProcess&)>& is_meant,
                            const std::atomic<bool>& at_once) {
  std::vector<Child*> ending;
  for (Child& child : children_) {
    if (!is_meant(child.process)) continue;
    child.finished = true;
    if (child.pid > 0) ending.push_back(&child);
  }
  for (const Child* child : ending) kill(child->pid, SIGTERM);
  Patience patience(options_);
  while (!ending.empty()) {
    read_output(kLook);
    std::erase_if(ending, [this](Child* child) {
      int status = 0;
      if (!reap(*child, &status)) return false;
      if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        say(fmt::format("{} {} while stopping", child->process.name, describe_status(status)));
      return true;
    });
    const bool one_is_at_work = std::any_of(children_.begin(), children_.end(),
                                            [](const Child& child) { return child.pid > 0 && is_at_work(child.pid); });
    const std::string why = at_once ? "everything is to end at once" : patience.end(one_is_at_work);
    if (why.empty()) continue;
    for (Child* child : std::exchange(ending, {})) {
      say(fmt::format("{} did not end when asked to: killed, as {}", child->process.name, why));
      kill_child(*child);
    }
  }
}

void Supervisor::stop_all(const std::atomic<bool>& at_once, const std::function<void()>& before_last_stage) {
  std::set<int> stages;
  for (const Child& child : children_) stages.insert(child.process.stop_stage);
  for (int stage : stages) {
    if (stage == *stages.rbegin() && before_last_stage && !at_once) before_last_stage();
    stop_those([stage](const ChildProcess& process) { return process.stop_stage == stage; }, at_once);
  }
}

// Whoever dies meanwhile is started and asked again.
std::string Supervisor::await_finish(const std::atomic<bool>& stop) {
  const auto works = [](const Child& child) { return child.process.finishes && !child.finished; };
  finishing_ = true;
  bool source_ended = true;
  std::string reason;
  while (!stop && reason.empty() && std::any_of(children_.begin(), children_.end(), works)) {
    for (Child& child : children_) {
      const bool is_due = Clock::now() - std::max(child.started, child.asked) >= kAskToFinish;
      if (!works(child) || child.pid <= 0 || !is_due) continue;
      child.asked = Clock::now();
      kill(child.pid, SIGUSR1);
    }
    read_output(kLook);
    reason = watch(&source_ended);
  }
  return reason;
}

void Supervisor::ask_to_reload() const {
  for (const Child& child : children_)
    if (child.process.reloads && child.pid > 0) kill(child.pid, SIGUSR2);
}

std::string Supervisor::run_beside(const ChildProcess& process, const std::atomic<bool>& at_once) {
  Child& child = children_.emplace_back();
  child.process = process;
  child.is_beside = true;
  std::string error;
  if (start(child)) {
    int status = 0;
    bool source_ended = true;
    while (!at_once && error.empty() && !reap(child, &status)) {
      read_output(kLook);
      error = watch(&source_ended);
    }
    if (child.pid > 0) {
      kill_child(child);
      error = fmt::format("{} was killed, as {}", process.name, error.empty() ? "everything is to end at once" : error);
    } else if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      error = fmt::format("{} {}", process.name, describe_status(status));
    }
  } else {
    error = fmt::format("{} cannot be started: {}", process.name, strerror(errno));
  }
  children_.pop_back();
  return error;
}

std::string Supervisor::run(const std::atomic<bool>& stop, const std::atomic<bool>& at_once, const Hooks& hooks) {
  std::string reason;
  for (Child& child : children_) {
    child.restart_at = Clock::now() + options_.source_delay;
    if (!child.process.source && !start(child)) {
      reason = fmt::format("{} cannot be started: {}", child.process.name, strerror(errno));
    }
  }
  bool source_ended = false;
  while (!stop && !source_ended && reason.empty()) {
    read_output(kLook);
    if (hooks.reload && hooks.reload()) ask_to_reload();
    reason = watch(&source_ended);
  }
  if (source_ended) {
    const auto settled = Clock::now() + options_.settle;
    while (!stop && reason.empty() && Clock::now() < settled) {
      read_output(kLook);
      reason = watch(&source_ended);
    }
  }
  // First, so that the others have time for what they have.
  stop_those([](const ChildProcess& process) { return process.source; }, at_once);
  if (reason.empty() && hooks.before_stop && !at_once) hooks.before_stop();
  if (source_ended && reason.empty()) reason = await_finish(stop);
  stop_all(at_once, reason.empty() ? hooks.before_last_stage : nullptr);
  return reason;
}

}  // namespace rumi::tool
