// SPDX-License-Identifier: BSD-3-Clause
// rumi config: prints the options with their values, as config/rumi.yaml and config/expert.yaml have them.
#include <fmt/format.h>

#include <memory>

#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/run/all_options.h"

namespace rumi::tool {
namespace {

struct Arguments : OptionFlags {
  bool expert = false;
};

void print(const Arguments& arguments) {
  AllOptions options;
  OptionTable table;
  describe(table, options);
  load(table, arguments);
  fmt::print("{}", table.to_yaml(arguments.expert ? OptionTable::Which::kExperts : OptionTable::Which::kUsers));
}

}  // namespace

void add_config_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command =
      app.add_command("config", "Print the options that a user sets, with their values, as YAML (config/rumi.yaml)");
  command->add_flag("--expert", arguments->expert, "the options that are for experts (config/expert.yaml)");
  add_option_flags(command, arguments.get());
  run_if_chosen(command, chosen, arguments, print);
}

}  // namespace rumi::tool
