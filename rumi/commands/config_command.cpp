// SPDX-License-Identifier: BSD-3-Clause
// rumi config: the options with their values, as config/rumi.yaml and config/expert.yaml have them.
#include <fmt/format.h>

#include <memory>

#include "base/command_line.h"
#include "rumi/commands/commands.h"
#include "rumi/run/all_options.h"

namespace rumi::tool {

void add_config_command(CommandLine& app, std::function<int()>* chosen) {
  auto config = std::make_shared<std::string>();
  auto settings = std::make_shared<std::vector<std::string>>();
  auto expert = std::make_shared<bool>(false);
  CommandLine* command =
      app.add_command("config", "Print the options that a user sets, with their values, as YAML (config/rumi.yaml)");
  command->add_flag("--expert", *expert, "the options that are for experts (config/expert.yaml)");
  command->add_option("--config", *config, "YAML file to begin with")->type_name("FILE");
  command->add_option("--set", *settings, "set one option, may be repeated; wins over --config")
      ->type_name("KEY=VALUE")
      .one_each();
  command->on_chosen([config, settings, expert, chosen] {
    *chosen = [config, settings, expert] {
      AllOptions options;
      OptionTable table;
      describe(table, options);
      if (const std::string error = load_options(table, *config, *settings); !error.empty()) {
        fmt::print(stderr, "rumi config: {}\n", error);
        return 2;
      }
      fmt::print("{}", table.to_yaml(*expert ? OptionTable::Which::kExperts : OptionTable::Which::kUsers));
      return 0;
    };
  });
}

}  // namespace rumi::tool
