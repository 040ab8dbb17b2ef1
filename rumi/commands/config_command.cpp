// SPDX-License-Identifier: BSD-3-Clause
// rumi config: every option with its default, as config/rumi.yaml has it.
#include <fmt/format.h>

#include <memory>

#include "base/command_line.h"
#include "rumi/commands/commands.h"
#include "rumi/run/all_options.h"

namespace rumi::tool {

void add_config_command(CommandLine& app, std::function<int()>* chosen) {
  auto config = std::make_shared<std::string>();
  auto settings = std::make_shared<std::vector<std::string>>();
  CommandLine* command = app.add_command("config", "Print every option with its value as YAML (see config/rumi.yaml)");
  command->add_option("--config", *config, "YAML file to begin with");
  command->add_option("--set", *settings, "KEY=VALUE, may be repeated")->one_each();
  command->on_chosen([config, settings, chosen] {
    *chosen = [config, settings] {
      AllOptions options;
      OptionTable table;
      describe(table, options);
      if (const std::string error = load_options(table, *config, *settings); !error.empty()) {
        fmt::print(stderr, "rumi config: {}\n", error);
        return 2;
      }
      fmt::print("{}", table.to_yaml());
      return 0;
    };
  });
}

}  // namespace rumi::tool
