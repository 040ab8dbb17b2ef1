// SPDX-License-Identifier: BSD-3-Clause
// Shared by all commands: how they end, and the flags that several have. A command ends by throwing its error, which is
// printed as "rumi NAME: error" and decides the exit code.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/command_line/command_line.h"
#include "base/command_line/options.h"
#include "base/result.h"
#include "bus/process/process.h"
#include "bus/transport/lcm_bus.h"

namespace rumi::tool {

// The exit code is 2; for any other exception it is 1.
class WrongOptions : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A failure ends the command by std::runtime_error, a refusal by WrongOptions.
void fail_if(const Result<>& result);
void fail_if(const std::string& error);  // does nothing if it is empty
void refuse_if(const Result<>& result);
void refuse_if(const std::string& error);

// The value of `result`; fails, or refuses, if it is an Error.
template <class T>
T value_or_fail(Result<T> result) {
  if (!result) fail_if(result.error().text());
  return *std::move(result);
}
template <class T>
T value_or_refuse(Result<T> result) {
  if (!result) refuse_if(result.error().text());
  return *std::move(result);
}

// Asked before the work begins, so that minutes of it are not lost. An Error if the file could not be written.
Result<> check_writable(const std::string& file);

// Prints "rumi NAME: what" on stderr, after flushing stdout. It does not throw if nobody reads stderr any more.
void complain(const std::string& name, const std::string& what);

// Returns the result of `work`, or the exit code for the exception that it throws. Every command fails if its stdout
// could not be written.
int run_command(const std::string& name, const std::function<int()>& work);

// If the user calls `command`, `run` is called with its arguments. It returns the exit code, or void for 0.
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
