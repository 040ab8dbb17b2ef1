// SPDX-License-Identifier: BSD-3-Clause
// The fields of a calibration file of any tool. Nested groups become one list of names with dots
// ("camera_matrix.data"). Fields remembers which ones were read, so that a user can be told of the others: a
// coefficient that is silently dropped makes every result a little wrong. It keeps the first error, so that the formats
// need no check after every line.
#pragma once

#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/result.h"

namespace rumi {

// Reads a list of "key: value"; throws YAML::Exception. Accepts OpenCV's "%YAML:1.0", a byte order mark and JSON.
YAML::Node load_yaml(std::string text);

// True for a whole number up to a million. Camera::check() judges whether an image may have a side of so many pixels.
bool is_side(double value);

// Limits what is parsed: calibrations come with images from the network, too. The longest real ones are a few kB.
inline constexpr size_t kMaxYamlBytes = 65536;

class Fields;
// Reads the fields of a text. An Error if the text is no list of "key: value"; `expected` tells the user what would be
// one.
Result<Fields> fields_of_text(const std::string& text, const std::string& name, const std::string& expected);

class Fields {
 public:
  Fields(const YAML::Node& root, std::string file);

  // Returns the fields that begin with `prefix`; they are asked for without it. The group starts with the error of the
  // whole, and without notes.
  Fields group(const std::string& prefix) const;

  const std::string& file() const { return file_; }
  const std::optional<Error>& error() const { return error_; }
  const std::vector<std::string>& notes() const { return notes_; }
  void fail(const std::string& what);
  void note(const std::string& what);

  bool has(const std::string& key) const { return values_.contains(prefix_ + key); }
  bool has_any(const std::string& prefix) const;  // true if a name begins with `prefix`
  std::vector<std::string> names() const;         // with the prefix, in the order of the file
  std::string full(const std::string& key) const { return prefix_ + key; }
  // Returns the first of these spellings that is in the file; if none is, the first of all.
  std::string spelling(std::initializer_list<const char*> keys) const;

  // A field that is missing, or not of this kind, is an error:
  double number(const std::string& key, const std::string& meaning);
  int size(const std::string& key);
  // Lists of lists are read row by row.
  std::vector<double> list(const std::string& key, const std::string& meaning);
  std::vector<double> list(const std::string& key, const std::string& meaning, size_t count);
  // A field that is missing is no error:
  double optional_number(const std::string& key);
  std::string text(const std::string& key, const std::string& otherwise);
  std::string quoted(const std::string& key) const;  // the text in the file, cut short for messages

  // Counts the keys that begin like this as read: they do not matter to a camera.
  void pass_over(std::initializer_list<const char*> beginnings);
  // Fails if a number of the optics, such as k4, is not 0 and was not read. If other keys were not read, adds a note
  // that names them.
  void tell_unused();

 private:
  void flatten(const YAML::Node& node, const std::string& name, int depth);
  void add(const std::string& name, const YAML::Node& node);
  const YAML::Node* find(const std::string& key);
  double to_number(const YAML::Node& node, const std::string& name, const std::string& meaning);
  void append(const YAML::Node& node, const std::string& name, const std::string& meaning, int depth,
              std::vector<double>* values);

  std::string file_, prefix_;
  std::optional<Error> error_;
  std::vector<std::string> notes_, order_;
  std::map<std::string, YAML::Node> values_;
  std::set<std::string> twice_, used_;
};

}  // namespace rumi
