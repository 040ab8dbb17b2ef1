// SPDX-License-Identifier: BSD-3-Clause
// Lets a bus have only one process of a name where receivers could not tell two apart: two front_trackers, or two
// drivers on one channel. A process that begins says so in a status (RUMI_STATUS, STARTING). If a process of the same
// name is there already, it answers at once, and the later one ends.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bus/transport/bus.h"
#include "lcmtypes/rumi/process_status_t.hpp"

namespace rumi {

// The name under which `rumi up` asks all processes for an answer before it starts any.
inline constexpr const char* kAsksEverybody = "rumi";

// Returns a status of this process in the state STARTING.
process_status_t starting_status(const std::string& process, int64_t now_us, int64_t started_us);
// True if the status is from another process that is alive. (A message of a process that was killed may still arrive.)
bool is_of_another(const process_status_t& status);
// Returns who published the status, such as "map_server, pid 12 on kitchen, for 7 s".
std::string describe(const process_status_t& status);

class OnlyOne {
 public:
  // `publishes`: the channel that only one process of this name may publish on; others of the name may publish on other
  // channels. If it is empty, the bus may have only one process of this name.
  OnlyOne(Bus& bus, std::string process, std::string publishes);

  // Asks the other processes on the bus. Dispatch the bus afterwards, so that answers reach problem(); a busy process
  // may take a second to answer.
  void ask();
  // Says, for a person, why this process must end; empty if it may go on. A process that was alone for three seconds
  // may always go on.
  const std::string& problem() const { return problem_; }
  // True if another process asked since the last call: then the status is to be published now.
  bool take_question();
  // Describes, for a person, another process of this name that goes on beside this one; empty if no new one was heard
  // since the last call.
  std::string take_warning();

  int64_t started_us() const { return started_us_; }
  const std::string& publishes() const { return publishes_; }

 private:
  void on_status(const process_status_t& status);
  bool is_rival(const process_status_t& status) const;
  bool was_before_us(const process_status_t& status) const;

  Bus& bus_;
  const std::string process_, publishes_;
  const int64_t started_us_;
  std::string problem_, warning_;
  int32_t warned_of_ = 0;  // pid of the process in the last warning; 0: there was no warning
  bool asked_ = false;
};

}  // namespace rumi
