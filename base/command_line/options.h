// SPDX-License-Identifier: BSD-3-Clause
// Named options with default, unit, range and help. They are read from YAML, set by --set key=value, shown by --help.
//
//   void describe(OptionTable& table, TrackerOptions& o) {
//     table.add("front_tracker.keypoints", &o.keypoints, "", "keypoints per frame", 50, 20000);
//   }
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace rumi {

class OptionTable {
 public:
  // `key` is "section.name". The default is the value that *field has now. The field must outlive the table. Numbers
  // outside [min, max] and NaN are refused. `unit` is "px", "s", "frames", ... or "". A key may be added again with the
  // same default, unit, range and help: then its value goes into both fields, as for an option that two components
  // share.
  void add(const std::string& key, int* field, const std::string& unit, const std::string& help, int min, int max);
  void add(const std::string& key, double* field, const std::string& unit, const std::string& help, double min,
           double max);
  void add(const std::string& key, bool* field, const std::string& help);
  void add(const std::string& key, std::string* field, const std::string& help,
           const std::vector<std::string>& choices = {});

  // Options that are added from now on belong to this group, which is a heading within the section in the experts'
  // YAML.
  void group(const std::string& room) { group_ = room; }
  // Marks the options that users need; all others are for experts, who tune Rumi. Throws if a key was not added.
  void for_users(const std::vector<std::string>& keys);

  // load_yaml(), load_yaml_text() and set() return an empty string, or an error message: file, key, value and what
  // would be right (the nearest key for an unknown one). A file with an error changes nothing. Sections of other
  // processes are skipped; a section that no process has, or an unknown key in a section of this table, is an error.
  std::string load_yaml(const std::string& file);
  std::string load_yaml_text(const std::string& text, const std::string& name_for_errors);
  // `setting` is "KEY=VALUE", or a result of by_flag().
  std::string set(const std::string& setting);
  // Sets all fields to their defaults.
  void reset();

  enum class Which { kUsers, kExperts, kAll };
  // Returns one line per option: key, default, unit, range, help.
  std::string help(Which which) const;
  // Returns the present values as YAML, with the help as comments. load_yaml() can read it.
  std::string to_yaml(Which which) const;

 private:
  using Field = std::variant<int*, double*, bool*, std::string*>;
  struct Entry {
    std::string key, unit, help;
    std::vector<Field> fields;  // all have the same value
    double min = 0, max = 0;
    std::vector<std::string> choices;
    std::string default_text;  // the default as shown to a person (text in quotes)
    std::string initial;       // the default as assign() reads it (text without quotes)
    std::string group;
    bool is_for_users = false;
  };
  static std::string assign(const Entry& entry, const std::string& text, bool apply);
  static std::string assign_to(const Field& field, const Entry& entry, const std::string& text, bool apply);
  const Entry* find(const std::string& key) const;
  std::string unknown(const std::string& key) const;
  std::string unknown_section(const std::string& key) const;
  std::string range_text(const Entry& entry) const;
  std::string describe(const Entry& entry) const;
  void insert(Entry entry);
  static bool is_meant(const Entry& entry, Which which);
  std::vector<Entry> entries_;
  std::string group_;
};

// Returns a setting for set() whose value comes from a flag ("--every") and not from --set: errors name that flag.
std::string by_flag(const std::string& flag, const std::string& key, const std::string& value);

// Sets the table's options from a file (may be empty) and then from settings (see set()). Returns an error message, or
// an empty string.
std::string load_options(OptionTable& table, const std::string& config_file, const std::vector<std::string>& settings);

}  // namespace rumi
