// SPDX-License-Identifier: BSD-3-Clause
// Common parts of all commands: how they end, and the flags of several commands. A command fails by throwing; the
// message is printed as "rumi NAME: error", and the type of the exception decides the exit code.
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

// The user has to correct the options. The exit code is 2; for any other exception it is 1.
class WrongOptions : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// fail_if() throws std::runtime_error, refuse_if() throws WrongOptions: if `result` is an Error or `error` is not
// empty.
void fail_if(const Result<>& result);
void fail_if(const std::string& error);
void refuse_if(const Result<>& result);
void refuse_if(const std::string& error);

// Returns the value of `result`. For an Error, throws as fail_if() or refuse_if() does.
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

// An Error if the file cannot be written. Commands call it before they begin, so that no work is lost.
Result<> check_writable(const std::string& file);

// Prints "rumi NAME: what" on stderr, after flushing stdout. It does not throw, even if stderr is closed.
void complain(const std::string& name, const std::string& what);

// Returns the exit code that `work` returns, or prints the exception that it throws and returns its exit code. A stdout
// that cannot be written is an error of every command.
int run_command(const std::string& name, const std::function<int()>& work);

// Sets *chosen, if the user calls `command`, to a function that calls `run` with the arguments. `run` returns the exit
// code, or void for 0.
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
// Adds --config and --set.
void add_option_flags(CommandLine* command, OptionFlags* flags);
// Sets the options in `table` from the flags. Throws WrongOptions.
void load(OptionTable& table, const OptionFlags& flags);

struct BusFlags {
  std::string lcm_url = kDefaultLcmUrl;
  ChannelNames names;
};
// Adds --lcm-url and --channel-prefix.
void add_bus_flags(CommandLine* command, BusFlags* flags);
// Throws std::runtime_error if the bus cannot be opened.
std::unique_ptr<LcmBus> open_bus(const BusFlags& flags);

}  // namespace rumi::tool
