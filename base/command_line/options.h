// SPDX-License-Identifier: BSD-3-Clause
// Named options with default, unit, range and help: read from YAML, changed by --set key=value, printed by --help.
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
  // key is "section.name"; the value that *field has now is the default. The field must outlive the table. Numbers
  // outside [min, max] and NaN are refused. unit is "px", "s", "frames", ... or "". A key that is added again, all
  // alike, has one more field: what two components must have the same.
  void add(const std::string& key, int* field, const std::string& unit, const std::string& help, int min, int max);
  void add(const std::string& key, double* field, const std::string& unit, const std::string& help, double min,
           double max);
  void add(const std::string& key, bool* field, const std::string& help);
  void add(const std::string& key, std::string* field, const std::string& help,
           const std::vector<std::string>& choices = {});

  // Options that are added from now on belong to this room of the section: a heading in the experts' YAML.
  void group(const std::string& room) { group_ = room; }
  // Names the options for users; all others are for experts, who tune or try out. Throws for a key that was not added.
  void for_users(const std::vector<std::string>& keys);

  // All return an empty string, or what is wrong: file, key, value and what would be right (the nearest key for an
  // unknown one). Nothing is changed by a file that has an error. Sections of other processes are accepted; those of
  // none, and unknown keys in a section of this table, are not.
  std::string load_yaml(const std::string& file);
  std::string load_yaml_text(const std::string& text, const std::string& name_for_errors);
  // "KEY=VALUE", or what by_flag() made.
  std::string set(const std::string& setting);
  // All fields have their defaults again.
  void reset();

  enum class Which { kUsers, kExperts, kAll };
  // One line per option: key, default, unit, range, help.
  std::string help(Which which) const;
  // The present values as YAML with the help as comments; load_yaml reads it back.
  std::string to_yaml(Which which) const;

 private:
  using Field = std::variant<int*, double*, bool*, std::string*>;
  struct Entry {
    std::string key, unit, help;
    std::vector<Field> fields;  // all have the same value
    double min = 0, max = 0;
    std::vector<std::string> choices;
    std::string default_text;  // for a person
    std::string initial;       // the same as assign() reads it
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

// The setting that a flag of its own ("--every") gives; what is wrong with it is told by the flag's name.
std::string by_flag(const std::string& flag, const std::string& key, const std::string& value);

// Fills the table's fields from a file (may be empty) and from settings, see set(). Returns what is wrong, or nothing.
std::string load_options(OptionTable& table, const std::string& config_file, const std::vector<std::string>& settings);

}  // namespace rumi
