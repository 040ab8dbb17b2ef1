// SPDX-License-Identifier: BSD-3-Clause
// Starts processes, puts their names before the lines of their output, restarts those that die, and stops all in order.
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
  std::vector<std::string> command;  // path of the program, and its arguments
  bool source = false;               // the source of images: when it ends with success, everything ends
  int stop_stage = 0;                // processes are stopped stage by stage, the lowest first
  bool finishes = false;             // when the source has ended, it is asked (SIGUSR1) to end after its work
  bool reloads = false;              // it reads its options again when asked (SIGUSR2)
  bool fails_once = false;           // it is not restarted after a failure, as it would fail again
};

struct SupervisorOptions {
  std::chrono::milliseconds source_delay{1000};  // the source starts later, so that the others hear all of it
  // A process that died is restarted after this delay, which doubles with each death up to restart_delay_max. A process
  // that had run for longer than restart_delay_max is restarted at once.
  std::chrono::milliseconds restart_delay{500};
  std::chrono::milliseconds restart_delay_max{10000};
  std::chrono::milliseconds failed_start{2000};  // a process that dies within this time counts as not started
  int max_failed_starts = 3;                     // failed starts of one process in a row; then the supervisor gives up
  std::chrono::milliseconds settle{2000};        // from the end of the source to the stop of the others
  // A process that was asked to end is killed if no process has done any work for stop_idle (processes wait up to 5 s
  // for each other), and after stop_limit in any case.
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

  // Called while the processes run. The first two are not called if the supervisor gave up, or if everything is to end
  // at once.
  struct Hooks {
    std::function<void()> before_stop;        // all processes except the source still run
    std::function<void()> before_last_stage;  // only the processes of the last stage still run
    // Called often. If it returns true, processes with `reloads` are asked to read their options again.
    std::function<bool()> reload;
  };
  // Runs until the source and the processes with `finishes` have ended, `stop` becomes true, or a process cannot be
  // kept alive; then stops all processes. When `at_once` becomes true, those that still run are killed. An Error says
  // why the supervisor gave up.
  Result<> run(const std::atomic<bool>& stop, const std::atomic<bool>& at_once, const Hooks& hooks);

  // Call it only in a hook. Runs a process to its end, or until `at_once` becomes true. Meanwhile it reads the output
  // of the other processes (which would stop when their pipes are full), and restarts those that die. An Error says why
  // the process failed.
  Result<> run_beside(const Supervised& what, const std::atomic<bool>& at_once);

  int restarts() const { return restarts_; }
  // True if a process ended with kNotAll: not all of the input was played, or the run was not localized.
  bool not_all() const { return not_all_; }
  // The last lines of the processes that ended with kNotAll, if these lines were errors, such as "front_tracker: 75 of
  // 150 images refused: ...".
  const std::vector<std::string>& complaints() const { return complaints_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Process {
    Supervised what;
    std::optional<Child> child;            // absent if the process does not run
    std::string partial;                   // the beginning of a line that is not yet complete
    std::string last_line;                 // the last complete line
    std::vector<std::string> last_errors;  // the errors with which the output ends
    Clock::time_point started, restart_at, asked;
    std::chrono::milliseconds delay{0};
    int failed_starts = 0;
    bool finished = false;   // has ended as it should, so it is not restarted
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
