// SPDX-License-Identifier: BSD-3-Clause
// The flags of a program or of one of its commands, read by CLI11. Only command_line.cpp includes CLI11's headers: they
// cost seconds of compile time in each file.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace rumi {

// Describes one flag or argument; each method returns the flag again.
class Flag {
 public:
  explicit Flag(CLI::Option* option) : option_(option) {}
  Flag* operator->() { return this; }

  Flag& required();
  // --help shows the present value of the variable as the default.
  Flag& show_default();
  // --help shows `value` as the default; for a flag whose value is not kept in a variable.
  Flag& shown_default(const std::string& value);
  // Sets what --help calls the value: "FILE".
  Flag& type_name(const std::string& name);
  // If the flag is not given, its value is taken from this environment variable.
  Flag& envname(const std::string& name);
  // The flag of a vector takes one value each time it is given.
  Flag& one_each();
  // The methods from here on make parse() refuse all other values.
  Flag& positive();
  Flag& not_negative();
  Flag& in_range(int low, int high);
  Flag& in_range(double low, double high);
  Flag& one_of(const std::vector<std::string>& values);

 private:
  CLI::Option* option_;
};

class CommandLine {
 public:
  // From now on a write beyond the limit of file sizes (`ulimit -f`) fails as on a full disk instead of ending the
  // program, and closed standard streams are occupied (see standard_output.h).
  CommandLine(const std::string& summary, const std::string& program);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  // `names`: "-o,--output", or "INPUT" for an argument without a flag. `value` must outlive parse(). T is std::string,
  // int, uint64_t, double, an optional of one of these (not of uint64_t), or a vector of strings or doubles.
  template <class T>
  Flag add_option(const std::string& names, T& value, const std::string& help);
  Flag add_option(const std::string& names, const std::function<void(const std::string&)>& take,
                  const std::string& help);
  Flag add_flag(const std::string& names, bool& value, const std::string& help);
  Flag add_flag(const std::string& names, std::function<void()> take, const std::string& help);
  // Adds a flag that calls `act` and then ends parse() without an error, as --help does.
  void add_action(const std::string& names, std::function<void()> act, const std::string& help);
  void set_version(const std::string& version);
  // Sets the text below the flags in --help.
  void footer(const std::string& text);

  // Adds a command. If a program has commands, the user must choose one; parse() calls its on_chosen() at the end.
  CommandLine* add_command(const std::string& name, const std::string& summary);
  bool has_command(const std::string& name) const;
  // Names a command that another program handles, so that it is suggested when a command is misspelt.
  void add_other_command(const std::string& name) { other_commands_.push_back(name); }
  void on_chosen(std::function<void()> chosen);

  struct Result {
    bool done = false;  // --help, --version or an action was carried out: the program should end
    std::string error;  // an error in the command line; empty if there is none
  };
  Result parse(int argc, char** argv);
  std::string help() const;

 private:
  explicit CommandLine(CLI::App* command);
  std::string misspelt(int argc, char** argv) const;
  std::unique_ptr<CLI::App> own_;  // null for a command: the program's CLI::App owns it
  CLI::App* app_;
  std::vector<std::unique_ptr<CommandLine>> commands_;
  std::vector<std::string> other_commands_;
};

}  // namespace rumi
