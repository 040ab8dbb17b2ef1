// SPDX-License-Identifier: BSD-3-Clause
// The fields of a calibration file, whatever tool it is of: groups within groups are one list of names with dots
// ("camera_matrix.data"). What was read is remembered, so that what was not can be told: a coefficient that is dropped
// without a word makes every result a little wrong. The first error is kept, so that the formats need no check after
// every line.
#pragma once

#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace rumi {

// A list of "key: value"; throws YAML::Exception. OpenCV's "%YAML:1.0", a byte order mark and JSON are taken for YAML.
YAML::Node load_yaml(std::string text);

// A whole number of pixels, and no more than any image has.
bool is_side(double value);

// A calibration also comes with every image from the network; the longest real ones are a few kB.
inline constexpr size_t kMaxYamlBytes = 65536;

class Fields;
// Nothing, and why in *error, for a text that is no list of "key: value". `expected` tells a user what would be one.
std::optional<Fields> fields_of_text(const std::string& text, const std::string& name, const std::string& expected,
                                     std::string* error);

class Fields {
 public:
  Fields(const YAML::Node& root, std::string file);

  // Those that begin with `prefix`, to be asked for without it. It begins with this one's error, and no notes.
  Fields group(const std::string& prefix) const;

  const std::string& file() const { return file_; }
  const std::string& error() const { return error_; }
  const std::vector<std::string>& notes() const { return notes_; }
  void fail(const std::string& what);
  void note(const std::string& what);

  bool has(const std::string& key) const { return values_.contains(prefix_ + key); }
  bool has_any(const std::string& prefix) const;  // of those that begin so
  std::vector<std::string> names() const;         // all, with the prefix, in the order of the file
  std::string full(const std::string& key) const { return prefix_ + key; }
  // The first of several spellings that is there; else the first.
  std::string spelling(std::initializer_list<const char*> keys) const;

  // For these a field that is missing, or not of this kind, is an error.
  double number(const std::string& key, const std::string& meaning);
  int size(const std::string& key);
  // Lists of lists are read row by row.
  std::vector<double> list(const std::string& key, const std::string& meaning);
  std::vector<double> list(const std::string& key, const std::string& meaning, size_t count);
  // For these it is not.
  double optional_number(const std::string& key);
  std::string text(const std::string& key, const std::string& otherwise);
  std::string quoted(const std::string& key) const;  // as it stands in the file, cut short for messages

  // Keys that begin so are of no importance for a camera: nothing is said of them.
  void pass_over(std::initializer_list<const char*> beginnings);
  // A number in a key of optics, such as k4, that was not read refuses the file; other keys are told in a note.
  void tell_unused();

 private:
  void flatten(const YAML::Node& node, const std::string& name, int depth);
  void add(const std::string& name, const YAML::Node& node);
  const YAML::Node* find(const std::string& key);
  double to_number(const YAML::Node& node, const std::string& name, const std::string& meaning);
  void append(const YAML::Node& node, const std::string& name, const std::string& meaning, int depth,
              std::vector<double>* values);

  std::string file_, prefix_, error_;
  std::vector<std::string> notes_, order_;
  std::map<std::string, YAML::Node> values_;
  std::set<std::string> twice_, used_;
};

}  // namespace rumi
