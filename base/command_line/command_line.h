// SPDX-License-Identifier: BSD-3-Clause
// A program's or a command's flags, read by CLI11, whose headers only command_line.cpp includes: they take the compiler
// seconds in every file.
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
  // --help shows the value that the variable has now.
  Flag& show_default();
  // --help shows this one: of a value that is not in a variable.
  Flag& shown_default(const std::string& value);
  // How --help names the value: "FILE".
  Flag& type_name(const std::string& name);
  // This environment variable replaces a flag that is not given.
  Flag& envname(const std::string& name);
  // A vector's flag is given once for each value.
  Flag& one_each();
  // These refuse other values.
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
  // From now on a file that would exceed the limit of file sizes (`ulimit -f`) fails as on a full disk, and does not
  // end the program; closed standard streams are held (standard_output.h).
  CommandLine(const std::string& summary, const std::string& program);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  // names: "-o,--output", or "INPUT" for what has no flag. The value must outlive parse(). T: std::string, int,
  // uint64_t, double, an optional of these but uint64_t, a vector of strings or doubles.
  template <class T>
  Flag add_option(const std::string& names, T& value, const std::string& help);
  Flag add_option(const std::string& names, const std::function<void(const std::string&)>& take,
                  const std::string& help);
  Flag add_flag(const std::string& names, bool& value, const std::string& help);
  Flag add_flag(const std::string& names, std::function<void()> take, const std::string& help);
  // Does something and ends the program well, as --help does.
  void add_action(const std::string& names, std::function<void()> act, const std::string& help);
  void set_version(const std::string& version);
  // Sets the text below the flags in --help.
  void footer(const std::string& text);

  // If there are commands, the user must choose one; its `chosen` is called at the end of parse().
  CommandLine* add_command(const std::string& name, const std::string& summary);
  bool has_command(const std::string& name) const;
  // Names a command that is not read here, for suggestions when a command is misspelt.
  void add_other_command(const std::string& name) { other_commands_.push_back(name); }
  void on_chosen(std::function<void()> chosen);

  struct Result {
    bool done = false;  // --help, --version or an action: there is nothing more to do
    std::string error;  // the error in the command line; may be empty
  };
  Result parse(int argc, char** argv);
  std::string help() const;

 private:
  explicit CommandLine(CLI::App* command);
  std::string misspelt(int argc, char** argv) const;
  std::unique_ptr<CLI::App> own_;  // null for a command of a program
  CLI::App* app_;
  std::vector<std::unique_ptr<CommandLine>> commands_;
  std::vector<std::string> other_commands_;
};

}  // namespace rumi
