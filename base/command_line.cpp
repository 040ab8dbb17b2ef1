// SPDX-License-Identifier: BSD-3-Clause
#include "base/command_line.h"

#include <CLI/CLI.hpp>
#include <optional>

namespace rumi {

Flag& Flag::required() { return option_->required(), *this; }
Flag& Flag::show_default() { return option_->capture_default_str(), *this; }
Flag& Flag::type_name(const std::string& name) { return option_->type_name(name), *this; }
Flag& Flag::envname(const std::string& name) { return option_->envname(name), *this; }
Flag& Flag::one_each() { return option_->allow_extra_args(false), *this; }
Flag& Flag::positive() { return option_->check(CLI::PositiveNumber), *this; }
Flag& Flag::not_negative() { return option_->check(CLI::NonNegativeNumber), *this; }
Flag& Flag::in_range(int low, int high) { return option_->check(CLI::Range(low, high)), *this; }
Flag& Flag::in_range(double low, double high) { return option_->check(CLI::Range(low, high)), *this; }
Flag& Flag::one_of(const std::vector<std::string>& values) { return option_->check(CLI::IsMember(values)), *this; }
Flag& Flag::existing_file() { return option_->check(CLI::ExistingFile), *this; }

CommandLine::CommandLine(const std::string& summary, const std::string& program)
    : own_(std::make_unique<CLI::App>(summary, program)), app_(own_.get()) {}
CommandLine::CommandLine(CLI::App* command) : app_(command) {}
CommandLine::~CommandLine() = default;

template <class T>
Flag CommandLine::add_option(const std::string& names, T& value, const std::string& help) {
  return Flag(app_->add_option(names, value, help));
}
template Flag CommandLine::add_option(const std::string&, std::string&, const std::string&);
template Flag CommandLine::add_option(const std::string&, int&, const std::string&);
template Flag CommandLine::add_option(const std::string&, uint64_t&, const std::string&);
template Flag CommandLine::add_option(const std::string&, double&, const std::string&);
template Flag CommandLine::add_option(const std::string&, std::optional<std::string>&, const std::string&);
template Flag CommandLine::add_option(const std::string&, std::optional<int>&, const std::string&);
template Flag CommandLine::add_option(const std::string&, std::optional<double>&, const std::string&);
template Flag CommandLine::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Flag CommandLine::add_option(const std::string&, std::vector<double>&, const std::string&);

Flag CommandLine::add_option(const std::string& names, const std::function<void(const std::string&)>& take,
                             const std::string& help) {
  return Flag(app_->add_option_function<std::string>(names, take, help));
}

Flag CommandLine::add_flag(const std::string& names, bool& value, const std::string& help) {
  return Flag(app_->add_flag(names, value, help));
}

void CommandLine::add_action(const std::string& names, std::function<void()> act, const std::string& help) {
  app_->add_flag_callback(
      names,
      [act = std::move(act)] {
        act();
        throw CLI::Success();
      },
      help);
}

void CommandLine::set_version(const std::string& version) { app_->set_version_flag("--version", version); }
void CommandLine::footer(const std::string& text) { app_->footer(text); }
void CommandLine::allow_extras() { app_->allow_extras(); }
std::vector<std::string> CommandLine::remaining() const { return app_->remaining(); }

CommandLine* CommandLine::add_command(const std::string& name, const std::string& summary) {
  app_->require_subcommand(1);
  commands_.push_back(std::unique_ptr<CommandLine>(new CommandLine(app_->add_subcommand(name, summary))));
  return commands_.back().get();
}

void CommandLine::on_chosen(std::function<void()> chosen) { app_->callback(std::move(chosen)); }

CommandLine::Result CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& e) {
    app_->exit(e);
    return {.done = true, .error = ""};
  } catch (const CLI::ParseError& e) {
    return {.done = false, .error = e.what()};
  }
  return {};
}

std::string CommandLine::help() const { return app_->help(); }

}  // namespace rumi
