// SPDX-License-Identifier: BSD-3-Clause
// A bus may have only one process of some names: receivers could not tell two front_trackers, or two drivers on one
// channel, apart. A process that begins says so (RUMI_STATUS, STARTING). One that is there already answers at once, and
// the later one ends.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bus/transport/bus.h"
#include "lcmtypes/rumi/process_status_t.hpp"

namespace rumi {

// The name under which `rumi up` asks all processes for an answer before it starts any.
inline constexpr const char* kAsksEverybody = "rumi";

// STARTING, of this process.
process_status_t starting_status(const std::string& process, int64_t now_us, int64_t started_us);
// Is the message from another process that is alive? (A message of a process that was killed may still arrive.)
bool is_of_another(const process_status_t& status);
// "map_server, pid 12 on kitchen, for 7 s".
std::string describe(const process_status_t& status);

class OnlyOne {
 public:
  // `publishes`: the channel of which there may be one publisher, so that others of this name may be on the bus that
  // publish on other channels; empty: there may be one of this name.
  OnlyOne(Bus& bus, std::string process, std::string publishes);

  // Asks the other processes. The bus must be dispatched until problem() is known; a busy process may answer within a
  // second.
  void ask();
  // Says, for a person, why this process must end; empty: it may go on. A process that was alone for three seconds may
  // go on.
  const std::string& problem() const { return problem_; }
  // Somebody asked since the last call: the status is to be published now.
  bool take_question();
  // Describes, for a person, a later process of this name that does not end although it should; since the last call.
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
  int32_t warned_of_ = 0;  // pid
  bool asked_ = false;
};

}  // namespace rumi
