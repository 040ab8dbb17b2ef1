// SPDX-License-Identifier: BSD-3-Clause
// What all commands have in common: how they end, and the flags that several have. A command throws what is wrong with
// it; that is said as "rumi NAME: what", and the exit code follows from it.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "base/command_line/command_line.h"
#include "base/command_line/options.h"
#include "bus/process/process.h"
#include "bus/transport/lcm_bus.h"

namespace rumi::tool {

// The exit code is 2; of any other exception it is 1.
class WrongOptions : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Each throws if `error` is not empty.
void fail_if(const std::string& error);    // std::runtime_error
void refuse_if(const std::string& error);  // WrongOptions

// That an output cannot be written should not turn out after minutes of work on it. What is wrong, or an empty string.
std::string check_writable(const std::string& file);

// Says "rumi NAME: what" on stderr, behind what went to stdout. Does not throw where nobody reads it any more.
void complain(const std::string& name, const std::string& what);

// Returns what `work` returns, or the exit code for what it throws. What was printed and could not be written is an
// error of every command.
int run_command(const std::string& name, const std::function<int()>& work);

// If the user calls `command`, `run` is run with its arguments. It returns the exit code, or nothing, which is 0.
template <class Arguments, class Run>
void run_if_chosen(CommandLine* command, std::function<int()>* chosen, const std::shared_ptr<Arguments>& arguments,
                   Run run) {
  command->on_chosen([=] {
    *chosen = [=] {
      if constexpr (std::is_void_v<std::invoke_result_t<Run, Arguments&>>)
        return run(*arguments), 0;
      else
        return run(*arguments);
    };
  });
}

struct OptionFlags {
  std::string config;
  std::vector<std::string> settings;
};
// --config and --set.
void add_option_flags(CommandLine* command, OptionFlags* flags);
// Throws WrongOptions.
void load(OptionTable& table, const OptionFlags& flags);

struct BusFlags {
  std::string lcm_url = kDefaultLcmUrl;
  ChannelNames names;
};
// --lcm-url and --channel-prefix.
void add_bus_flags(CommandLine* command, BusFlags* flags);
// Throws if there is no bus.
std::unique_ptr<LcmBus> open_bus(const BusFlags& flags);

}  // namespace rumi::tool
