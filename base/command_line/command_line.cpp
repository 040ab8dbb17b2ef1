// SPDX-License-Identifier: BSD-3-Clause
#include "base/command_line/command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <sstream>

#include "base/text/nearest_word.h"
#include "base/this_process/standard_output.h"

namespace rumi {

Flag& Flag::required() { return option_->required(), *this; }
Flag& Flag::show_default() { return option_->capture_default_str(), *this; }
Flag& Flag::shown_default(const std::string& value) { return option_->default_str(value), *this; }
Flag& Flag::type_name(const std::string& name) { return option_->type_name(name), *this; }
Flag& Flag::envname(const std::string& name) { return option_->envname(name), *this; }
Flag& Flag::one_each() { return option_->allow_extra_args(false), *this; }
namespace {

// Refuses text that is not a number or not in the range. NaN is in no range.
template <class IsRight>
CLI::Validator number(const std::string& range, const IsRight& is_right) {
  return {[range, is_right](const std::string& text) {
            char* end = nullptr;
            const double value = std::strtod(text.c_str(), &end);
            return end != text.c_str() && *end == '\0' && is_right(value) ? std::string()
                                                                          : fmt::format("'{}' must be {}", text, range);
          },
          ""};
}

}  // namespace

Flag& Flag::positive() {
  return option_->check(number("a number above 0", [](double value) { return value > 0 && std::isfinite(value); })),
         *this;
}
Flag& Flag::not_negative() {
  return option_->check(
             number("a number that is not negative", [](double value) { return value >= 0 && std::isfinite(value); })),
         *this;
}
Flag& Flag::in_range(int low, int high) {
  const auto is_right = [low, high](double value) {
    return value >= low && value <= high && value == std::floor(value);
  };
  return option_->check(number(fmt::format("a whole number from {} to {}", low, high), is_right)), *this;
}
Flag& Flag::in_range(double low, double high) {
  const auto is_right = [low, high](double value) { return value >= low && value <= high; };
  return option_->check(number(fmt::format("a number from {} to {}", low, high), is_right)), *this;
}
Flag& Flag::one_of(const std::vector<std::string>& values) {
  const auto is_right = [values](const std::string& text) {
    const bool known = std::find(values.begin(), values.end(), text) != values.end();
    return known ? std::string() : fmt::format("'{}' must be one of {}", text, fmt::join(values, ", "));
  };
  return option_->check(CLI::Validator(is_right, fmt::format("{}", fmt::join(values, "|")))), *this;
}

CommandLine::CommandLine(const std::string& summary, const std::string& program)
    : own_(std::make_unique<CLI::App>(summary, program)), app_(own_.get()) {
  std::signal(SIGXFSZ, SIG_IGN);
  hold_standard_streams();
}
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

Flag CommandLine::add_flag(const std::string& names, std::function<void()> take, const std::string& help) {
  return Flag(app_->add_flag_callback(names, std::move(take), help));
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

CommandLine* CommandLine::add_command(const std::string& name, const std::string& summary) {
  app_->require_subcommand(1);
  commands_.push_back(std::unique_ptr<CommandLine>(new CommandLine(app_->add_subcommand(name, summary))));
  return commands_.back().get();
}

bool CommandLine::has_command(const std::string& name) const {
  return !app_->get_subcommands([&](const CLI::App* command) { return command->get_name() == name; }).empty();
}

void CommandLine::on_chosen(std::function<void()> chosen) { app_->callback(std::move(chosen)); }

namespace {

void add_names(const CLI::App& app, std::vector<std::string>* names) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names->push_back("--" + name);
    for (const std::string& name : option->get_snames()) names->push_back("-" + name);
  }
}

bool is_number(const std::string& text) {
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return *end == '\0';
}

std::string no_such(const std::string& what, const std::string& word, const std::vector<std::string>& known) {
  const std::string similar = similar_word(word, known);
  return fmt::format("{}: there is no such {}{}", word, what, similar.empty() ? "" : "; did you mean " + similar + "?");
}

// Puts some of CLI11's messages into plain words; the others are plain enough.
std::string reason_of(const CLI::ParseError& error) {
  std::string text = error.what();
  constexpr const char* kNotConverted = "Could not convert: ";
  if (text.starts_with(kNotConverted)) return text.substr(std::strlen(kNotConverted)) + ": expected a number";
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) && text.ends_with(" missing"))
    return text.substr(0, text.find(':')) + ": its value is missing";
  if (text == "A subcommand is required") return "a command is missing";
  return text;
}

// CLI11 takes "-every" for five flags of one letter each: this suggests "--every".
std::string no_such_flag(const std::string& flag, const std::vector<std::string>& known) {
  if (flag.starts_with("--") || flag.size() == 2) return no_such("flag", flag, known);
  const std::string similar = similar_word("-" + flag, known);
  return similar.empty() ? no_such("flag", flag, {}) : fmt::format("{}: did you mean {}?", flag, similar);
}

}  // namespace

// Returns a message about the first misspelt flag or command: that is the usual cause, even if CLI11 says that
// something is missing. Returns an empty string if no word is misspelt.
std::string CommandLine::misspelt(int argc, char** argv) const {
  const CLI::App* app = app_;
  std::vector<std::string> known, commands;
  add_names(*app, &known);
  for (const CLI::App* command : app->get_subcommands([](const CLI::App*) { return true; }))
    commands.push_back(command->get_name());
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--") break;
    const bool is_flag = word.size() > 1 && word[0] == '-' && !is_number(word);
    if (!is_flag) {
      if (app != app_ || commands.empty()) continue;
      if (std::find(commands.begin(), commands.end(), word) == commands.end()) {
        commands.insert(commands.end(), other_commands_.begin(), other_commands_.end());
        return no_such("command", word, commands);
      }
      app = app_->get_subcommand(word);
      add_names(*app, &known);
      continue;
    }
    const std::string flag = word.substr(0, word.find('='));
    const bool is_long = flag.starts_with("--");
    const std::string name = is_long ? flag : flag.substr(0, 2);  // "-l" if the word is "-lURL"
    if (std::find(known.begin(), known.end(), name) == known.end()) return no_such_flag(flag, known);
  }
  return {};
}

CommandLine::Result CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& e) {
    std::ostringstream text;
    app_->exit(e, text);
    fmt::print("{}", text.str());  // throws with the reason if it cannot be written
    return {.done = true, .error = ""};
  } catch (const CLI::ParseError& e) {
    const std::string word = misspelt(argc, argv);
    return {.done = false, .error = word.empty() ? reason_of(e) : word};
  }
  return {};
}

std::string CommandLine::help() const { return app_->help(); }

}  // namespace rumi
