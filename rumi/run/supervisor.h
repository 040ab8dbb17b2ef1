// SPDX-License-Identifier: BSD-3-Clause
// Starts processes, prefixes their output with their names, restarts those that die, and stops all of them in order.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/child/child_process.h"
#include "base/result.h"

namespace rumi::tool {

struct Supervised {
  std::string name;
  std::vector<std::string> command;  // executable (path) and arguments
  bool source = false;               // the input: when it ends with success, everything ends
  int stop_stage = 0;                // stages are stopped one after another, lowest first
  bool finishes = false;             // at the end of the source it is asked (SIGUSR1) to end when its work is done
  bool reloads = false;              // reads its options again when asked (SIGUSR2)
  bool fails_once = false;           // after a failure it is not restarted, as it would fail again
};

struct SupervisorOptions {
  std::chrono::milliseconds source_delay{1000};  // the source starts later, so that the others hear all of it
  // A process that died soon after its start waits so long for the next one; the wait doubles each time, up to
  // restart_delay_max. A process that ran for longer than that is started again at once.
  std::chrono::milliseconds restart_delay{500};
  std::chrono::milliseconds restart_delay_max{10000};
  std::chrono::milliseconds failed_start{2000};  // a process that dies within this time did not start
  int max_failed_starts = 3;                     // in a row, of one process; then the supervisor gives up
  std::chrono::milliseconds settle{2000};        // from the end of the source to the stop of the others
  // A process that was asked to end is killed after stop_idle in which no running process did any work (they wait 5 s
  // for one another), and after stop_limit in any case.
  std::chrono::milliseconds stop_idle{6500};
  std::chrono::milliseconds stop_limit{60000};
};

class Supervisor {
 public:
  using LineHandler = std::function<void(const std::string& name, const std::string& line)>;

  Supervisor(std::vector<Supervised> processes, const SupervisorOptions& options, LineHandler on_line);
  // The destructor kills all processes that still run.
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  // Called while the processes run and before they are stopped. The first two are not called if the supervisor gave up.
  struct Hooks {
    std::function<void()> before_stop;        // all processes except the source are alive
    std::function<void()> before_last_stage;  // only those of the last stage are alive
    std::function<bool()> reload;  // called often; if true, processes with `reloads` are asked to read their options
  };
  // Runs until the source and the processes with `finishes` have ended, `stop` becomes true, or a process cannot be
  // kept alive. When `at_once` becomes true, processes that still run are killed. An Error says why the supervisor gave
  // up.
  Result<> run(const std::atomic<bool>& stop, const std::atomic<bool>& at_once, const Hooks& hooks);

  // For use in a hook: runs a process to its end, or until `at_once` becomes true. Meanwhile the output of the others
  // is read (a process whose pipe is full would stand still), and those that die are started again. An Error says
  // why the process failed.
  Result<> run_beside(const Supervised& what, const std::atomic<bool>& at_once);

  int restarts() const { return restarts_; }
  // A process ended with kNotAll: not all of the input was played, or the run was not localized.
  bool not_all() const { return not_all_; }
  // The last lines of those processes, if they were errors: "front_tracker: 75 of 150 images refused: ...".
  const std::vector<std::string>& complaints() const { return complaints_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Process {
    Supervised what;
    std::optional<Child> child;            // while it runs
    std::string partial;                   // the beginning of a line
    std::string last_line;                 // the last whole line
    std::vector<std::string> last_errors;  // errors at the end of the output
    Clock::time_point started, restart_at, asked;
    std::chrono::milliseconds delay{0};
    int failed_starts = 0;
    bool finished = false;   // has ended as it should, and is not restarted
    bool is_beside = false;  // see run_beside()
  };

  Result<> start(Process& process);
  void read_output(std::chrono::milliseconds timeout);
  void drain(Process& process);
  void take_line(Process& process, const std::string& line);
  Result<> watch(bool* source_ended);
  void ask_to_reload() const;
  Result<> await_finish(const std::atomic<bool>& stop);
  Result<> on_death(Process& process, const ChildEnd& end);
  void stop_those(const std::function<bool(const Supervised&)>& is_meant, const std::atomic<bool>& at_once);
  void kill_now(Process& process);
  void stop_all(const std::atomic<bool>& at_once, const std::function<void()>& before_last_stage);
  std::optional<ChildEnd> reap(Process& process);
  void say(const std::string& line) { on_line_("rumi", line); }

  std::vector<Process> processes_;
  SupervisorOptions options_;
  LineHandler on_line_;
  int restarts_ = 0;
  bool finishing_ = false, not_all_ = false;
  std::vector<std::string> complaints_;
};

}  // namespace rumi::tool
