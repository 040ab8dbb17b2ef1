// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/commands/command_frame.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "base/running/failures.h"
#include "base/this_process/standard_output.h"

namespace rumi::tool {

void fail_if(const std::string& error) {
  if (!error.empty()) throw std::runtime_error(error);
}

void refuse_if(const std::string& error) {
  if (!error.empty()) throw WrongOptions(error);
}

void fail_if(const Result<>& result) { fail_if(result.error_text()); }

void refuse_if(const Result<>& result) { refuse_if(result.error_text()); }

Result<> check_writable(const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code code;
  if (fs::is_directory(file, code)) return Error{"is a folder", file, "give the name of a file"};
  fs::path folder = fs::path(file).parent_path();
  if (folder.empty()) folder = ".";
  if (!fs::is_directory(folder, code)) return Error{"there is no folder " + folder.string(), file};
  if (access(folder.c_str(), W_OK) != 0) return Error{"no permission to write there", file};
  return {};
}

void complain(const std::string& name, const std::string& what) {
  flush_stdout();
  std::fputs(("rumi " + name + ": " + what + "\n").c_str(), stderr);
}

int run_command(const std::string& name, const std::function<int()>& work) {
  try {
    const int exit_code = work();
    fail_if(flush_stdout());
    return exit_code;
  } catch (const std::exception& e) {
    complain(name, reason_of(e));
    return dynamic_cast<const WrongOptions*>(&e) ? 2 : 1;
  }
}

void add_option_flags(CommandLine* command, OptionFlags* flags) {
  command->add_option("--config", flags->config, "YAML file with options, see config/rumi.yaml")->type_name("FILE");
  command
      ->add_option("--set", flags->settings,
                   "set one option (`rumi config` lists them), may be repeated; wins over --config")
      ->type_name("KEY=VALUE")
      .one_each();
}

void load(OptionTable& table, const OptionFlags& flags) {
  refuse_if(load_options(table, flags.config, flags.settings));
}

void add_bus_flags(CommandLine* command, BusFlags* flags) {
  command->add_option("-l,--lcm-url", flags->lcm_url, "LCM URL")->envname("LCM_DEFAULT_URL")->show_default();
  command->add_option("--channel-prefix", flags->names.prefix,
                      "put before every channel name (several robots on one bus)");
}

std::unique_ptr<LcmBus> open_bus(const BusFlags& flags) {
  return value_or_fail(LcmBus::open(flags.lcm_url, flags.names));
}

}  // namespace rumi::tool
