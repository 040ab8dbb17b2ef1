// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/supervisor.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>
#include <utility>

#include "base/this_process/exit_codes.h"

namespace rumi::tool {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLook{50};  // interval at which the processes are watched
// A process is asked to end this long after its start, because it must install a handler first. It is asked again at
// this interval.
constexpr milliseconds kAskToFinish{500};
constexpr size_t kLongestLine = 16384;  // bytes; a longer line is cut

bool is_not_all(const ChildEnd& end) { return end.exited() && end.exit_code() == kNotAll; }
bool ended_well(const ChildEnd& end) { return end.exited() && (end.exit_code() == 0 || is_not_all(end)); }

// True if a thread of the process runs, waits for a CPU, or waits for a disk. Its CPU time would not tell, because it
// may be little on a busy machine.
bool is_at_work(pid_t pid) {
  std::error_code error;
  const std::string threads = fmt::format("/proc/{}/task", pid);
  for (std::filesystem::directory_iterator it(threads, error), end; !error && it != end; it.increment(error)) {
    std::string text;
    std::getline(std::ifstream(it->path() / "stat"), text);
    const size_t name_end = text.rfind(')');  // the state follows the name
    if (name_end == std::string::npos || name_end + 2 >= text.size()) continue;
    if (const char state = text[name_end + 2]; state == 'R' || state == 'D') return true;
  }
  return false;
}

// Decides how long to wait for processes that were asked to end: as long as any process still works, because the others
// may be waiting for it.
class Patience {
 public:
  explicit Patience(const SupervisorOptions& options) : options_(options) {}

  // Call it every kLook. Returns an empty string, or the reason to wait no longer.
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
  static constexpr int kLooks = 6, kSeenAtWork = 3;  // seen in 3 of 6 looks: a waiting process wakes up now and then
  const SupervisorOptions& options_;
  const Clock::time_point begin_ = Clock::now();
  Clock::time_point last_work_ = begin_;
  int looks_ = 0, seen_at_work_ = 0;
};

constexpr std::string_view kLevel = " error ";

// Returns "a.mp4: ..." for "10:15:00.123 camera_driver error a.mp4: ...".
std::string without_log_head(const std::string& line) {
  const size_t level = line.find(kLevel);
  return level == std::string::npos ? line : line.substr(level + kLevel.size());
}

}  // namespace

Supervisor::Supervisor(std::vector<Supervised> processes, const SupervisorOptions& options, LineHandler on_line)
    : options_(options), on_line_(std::move(on_line)) {
  for (Supervised& what : processes) {
    Process process;
    process.what = std::move(what);
    process.delay = options_.restart_delay;
    processes_.push_back(std::move(process));
  }
}

Result<> Supervisor::start(Process& process) {
  ChildLaunch launch;
  launch.arguments = process.what.command;
  launch.death_signal = SIGTERM;  // if the supervisor is killed, the process can still end in order
  launch.held_signals = {SIGUSR1, SIGUSR2};
  Result<Child> child = Child::start(launch);
  process.started = Clock::now();
  process.child.reset();
  if (!child) return Error{fmt::format("{} cannot be started: {}", process.what.name, child.error_text())};
  process.child = std::move(*child);
  return {};
}

void Supervisor::take_line(Process& process, const std::string& line) {
  on_line_(process.what.name, line);
  process.last_line = line;
  if (line.find(kLevel) == std::string::npos)
    process.last_errors.clear();
  else
    process.last_errors.push_back(fmt::format("{}: {}", process.what.name, without_log_head(line)));
}

void Supervisor::drain(Process& process) {
  if (!process.child) return;
  char buffer[4096];
  for (ssize_t n; (n = read(process.child->output(), buffer, sizeof(buffer))) > 0;) {
    process.partial.append(buffer, static_cast<size_t>(n));
    size_t begin = 0;
    for (size_t end; (end = process.partial.find('\n', begin)) != std::string::npos; begin = end + 1) {
      take_line(process, process.partial.substr(begin, end - begin));
    }
    process.partial.erase(0, begin);
    if (process.partial.size() > kLongestLine) {
      on_line_(process.what.name, process.partial);
      process.partial.clear();
    }
  }
}

void Supervisor::read_output(milliseconds timeout) {
  std::vector<pollfd> fds;
  for (const Process& process : processes_) {
    if (process.child) fds.push_back({process.child->output(), POLLIN, 0});
  }
  const auto begin = Clock::now();
  poll(fds.data(), fds.size(), static_cast<int>(timeout.count()));
  for (Process& process : processes_) drain(process);
  // A pipe that was closed is always ready: without a pause, waiting for its process to die would be a busy loop.
  const bool hung_up = std::any_of(fds.begin(), fds.end(), [](const pollfd& fd) { return fd.revents & POLLHUP; });
  if (hung_up && Clock::now() - begin < timeout / 2) usleep(5000);
}

std::optional<ChildEnd> Supervisor::reap(Process& process) {
  if (!process.child || !process.child->has_ended()) return std::nullopt;
  const ChildEnd end = process.child->reap();  // also ends the children of the process, such as COLMAP
  drain(process);
  if (!process.partial.empty()) take_line(process, process.partial);
  process.partial.clear();
  process.child.reset();
  const bool was_cut_short =
      process.what.source && process.finished;  // the supervisor stopped it, because the user ended the run
  if (is_not_all(end) && !was_cut_short) {
    not_all_ = true;
    complaints_.insert(complaints_.end(), process.last_errors.begin(), process.last_errors.end());
  }
  process.last_errors.clear();
  return end;
}

// Plans a restart of the process. An Error if the supervisor must give up.
Result<> Supervisor::on_death(Process& process, const ChildEnd& end) {
  const std::string what = fmt::format("{} {}", process.what.name, end.describe());
  if (end.exited() && end.exit_code() == kNotAgain) return Error{what + ": starting it again would not help"};
  if (end.exited() && process.what.fails_once)
    return Error{process.last_line.empty()
                     ? what
                     : fmt::format("{}: {}", process.what.name, without_log_head(process.last_line))};
  const auto now = Clock::now();
  process.failed_starts = now - process.started < options_.failed_start ? process.failed_starts + 1 : 0;
  if (process.failed_starts >= options_.max_failed_starts) {
    return Error{fmt::format("{}, {} times in a row right after its start{}", what, process.failed_starts,
                             process.last_line.empty() ? "" : ": " + without_log_head(process.last_line))};
  }
  // Every image that comes meanwhile is lost, so a process that had run for long is restarted at once.
  if (now - process.started > options_.restart_delay_max) process.delay = milliseconds(0);
  const auto delay_s = std::chrono::duration<double>(process.delay).count();
  say(fmt::format("{}; starting it again {}", what, delay_s > 0 ? fmt::format("in {:.1f} s", delay_s) : "at once"));
  process.restart_at = now + process.delay;
  process.delay = std::min(std::max(2 * process.delay, options_.restart_delay), options_.restart_delay_max);
  return {};
}

Result<> Supervisor::watch(bool* source_ended) {
  for (Process& process : processes_) {
    if (process.is_beside) continue;
    if (const std::optional<ChildEnd> end = reap(process)) {
      if (process.what.source && ended_well(*end)) {
        *source_ended = process.finished = true;
        continue;
      }
      if (finishing_ && process.what.finishes && ended_well(*end)) {
        process.finished = true;
        continue;
      }
      if (const Result<> planned = on_death(process, *end); !planned) return planned;
    } else if (!process.child && !process.finished && Clock::now() >= process.restart_at) {
      const bool again = process.started != Clock::time_point();
      if (const Result<> started = start(process); !started) return started;
      restarts_ += again;
    }
  }
  return {};
}

void Supervisor::kill_now(Process& process) {
  process.child->send_to_group(SIGKILL);
  while (!reap(process)) usleep(1000);
}

void Supervisor::stop_those(const std::function<bool(const Supervised&)>& is_meant, const std::atomic<bool>& at_once) {
  std::vector<Process*> ending;
  for (Process& process : processes_) {
    if (!is_meant(process.what)) continue;
    process.finished = true;
    if (process.child) ending.push_back(&process);
  }
  for (const Process* process : ending) process->child->send(SIGTERM);
  Patience patience(options_);
  while (!ending.empty()) {
    read_output(kLook);
    std::erase_if(ending, [this](Process* process) {
      const std::optional<ChildEnd> end = reap(*process);
      if (end && !ended_well(*end)) say(fmt::format("{} {} while stopping", process->what.name, end->describe()));
      return end.has_value();
    });
    const bool one_is_at_work = std::any_of(processes_.begin(), processes_.end(), [](const Process& process) {
      return process.child && is_at_work(process.child->pid());
    });
    const std::string why = at_once ? "everything is to end at once" : patience.end(one_is_at_work);
    if (why.empty()) continue;
    for (Process* process : std::exchange(ending, {})) {
      say(fmt::format("{} did not end when asked to: killed, as {}", process->what.name, why));
      kill_now(*process);
    }
  }
}

void Supervisor::stop_all(const std::atomic<bool>& at_once, const std::function<void()>& before_last_stage) {
  std::set<int> stages;
  for (const Process& process : processes_) stages.insert(process.what.stop_stage);
  for (int stage : stages) {
    if (stage == *stages.rbegin() && before_last_stage && !at_once) before_last_stage();
    stop_those([stage](const Supervised& what) { return what.stop_stage == stage; }, at_once);
  }
}

// Asks the processes with `finishes` to end, and waits for them. One that dies meanwhile is restarted and asked again.
Result<> Supervisor::await_finish(const std::atomic<bool>& stop) {
  const auto works = [](const Process& process) { return process.what.finishes && !process.finished; };
  finishing_ = true;
  bool source_ended = true;
  Result<> alive;
  while (!stop && alive && std::any_of(processes_.begin(), processes_.end(), works)) {
    for (Process& process : processes_) {
      const bool is_due = Clock::now() - std::max(process.started, process.asked) >= kAskToFinish;
      if (!works(process) || !process.child || !is_due) continue;
      process.asked = Clock::now();
      process.child->send(SIGUSR1);
    }
    read_output(kLook);
    alive = watch(&source_ended);
  }
  return alive;
}

void Supervisor::ask_to_reload() const {
  for (const Process& process : processes_)
    if (process.what.reloads && process.child) process.child->send(SIGUSR2);
}

Result<> Supervisor::run_beside(const Supervised& what, const std::atomic<bool>& at_once) {
  Process& process = processes_.emplace_back();
  process.what = what;
  process.is_beside = true;
  Result<> result = start(process);
  if (result) {
    std::optional<ChildEnd> end;
    bool source_ended = true;
    while (!at_once && result && !(end = reap(process))) {
      read_output(kLook);
      result = watch(&source_ended);
    }
    if (process.child) {
      kill_now(process);
      result = Error{fmt::format("{} was killed, as {}", what.name,
                                 result ? "everything is to end at once" : result.error().text())};
    } else if (!end->exited() || end->exit_code() != 0) {
      result = Error{fmt::format("{} {}", what.name, end->describe())};
    }
  }
  processes_.pop_back();
  return result;
}

Result<> Supervisor::run(const std::atomic<bool>& stop, const std::atomic<bool>& at_once, const Hooks& hooks) {
  Result<> alive;
  for (Process& process : processes_) {
    process.restart_at = Clock::now() + options_.source_delay;
    if (!process.what.source && alive) alive = start(process);
  }
  bool source_ended = false;
  while (!stop && !source_ended && alive) {
    read_output(kLook);
    if (hooks.reload && hooks.reload()) ask_to_reload();
    alive = watch(&source_ended);
  }
  if (source_ended) {
    const auto settled = Clock::now() + options_.settle;
    while (!stop && alive && Clock::now() < settled) {
      read_output(kLook);
      alive = watch(&source_ended);
    }
  }
  // The source is stopped first, so that the other processes have time to complete their work.
  stop_those([](const Supervised& what) { return what.source; }, at_once);
  if (alive && hooks.before_stop && !at_once) hooks.before_stop();
  if (source_ended && alive) alive = await_finish(stop);
  stop_all(at_once, alive ? hooks.before_last_stage : nullptr);
  return alive;
}

}  // namespace rumi::tool
