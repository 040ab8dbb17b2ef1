// SPDX-License-Identifier: BSD-3-Clause
#include "base/command_line/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <stdexcept>

#include "base/text/nearest_word.h"
#include "base/text/number_text.h"

namespace rumi {
namespace {

constexpr size_t kHelpColumn = 46;    // column at which the help text begins
constexpr size_t kMostLetters = 100;  // letters of a key that a message shows, at most

// Sections that any process has. All processes share one file, and each skips the sections of the others.
const std::set<std::string> kSectionsOfAll = {"up",        "camera_driver", "image",           "front_tracker",
                                              "ruminator", "map_server",    "viewer_offscreen"};
// A camera's calibration has one of these keys at its top level; used to recognize one that was given as options.
const std::set<std::string> kKeysOfCalibrations = {
    "fx", "camera_matrix", "image_width", "intrinsics", "resolution", "model_type", "model", "cam0", "Camera"};

std::string section_of(const std::string& key) { return key.substr(0, key.find('.')); }

std::string shortened(const std::string& key) {
  return fmt::format("{}{}", key.substr(0, kMostLetters), key.size() > kMostLetters ? "..." : "");
}

// Quotes text so that YAML reads it back. YAML::Emitter would replace bytes that are not UTF-8, and a file name with
// such bytes (from an old Windows disk) would no longer name its file.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < ' ' || byte == 0x7f)
      result += fmt::format("\\x{:02x}", byte);
    else
      result += (c == '"' || c == '\\') ? std::string{'\\', c} : std::string{c};
  }
  return result + '"';
}

std::string value_text(const std::variant<int*, double*, bool*, std::string*>& field) {
  return std::visit(
      [](const auto* value) {
        if constexpr (std::is_same_v<decltype(value), const std::string*>)
          return quoted(*value);
        else
          return fmt::format("{}", *value);
      },
      field);
}

std::string name_of(const std::string& key) { return key.substr(key.rfind('.') + 1); }

// Returns the key with the same name in another section, or else the most similar key; empty if none is similar.
std::string key_meant_by(const std::string& key, const std::vector<std::string>& keys) {
  std::vector<std::string> names;
  names.reserve(keys.size());
  for (const std::string& known : keys) names.push_back(name_of(known));
  const auto key_of = [&](const std::string& name) {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? "" : keys[static_cast<size_t>(at - names.begin())];
  };
  if (const std::string elsewhere = key_of(name_of(key)); !elsewhere.empty()) return elsewhere;
  const bool has_section = key.find('.') != std::string::npos;
  return has_section ? similar_word(key, keys) : key_of(similar_word(key, names));
}

template <class Entries>
auto* find_in(Entries& entries, const std::string& key) {
  const auto it = std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.key == key; });
  return it == entries.end() ? nullptr : &*it;
}

struct FlatValue {
  std::string key, text;
  bool is_empty = false;  // `key:` with nothing behind it
  int line = 0;
};

// Limits the size of a YAML file: with anchors a group can contain itself, or a few lines expand to a billion nodes.
struct Extent {
  static constexpr int kDeepest = 50;
  static constexpr int kMostNodes = 100'000;
  int depth = 0, nodes = 0;
  bool is_too_large() const { return depth > kDeepest || nodes > kMostNodes; }
};

// Flattens groups: a: {b: {c: 1}} -> a.b.c = 1. Returns an error message, or an empty string.
std::string flatten(const YAML::Node& node, const std::string& key, Extent* extent, std::vector<FlatValue>* out) {
  const int line = node.Mark().line + 1;
  ++extent->nodes;
  if (extent->is_too_large())
    return fmt::format("line {}: groups within groups without end; remove the anchors (&name, *name)", line);
  if (node.IsMap()) {
    for (const auto& item : node) {
      if (!item.first.IsScalar()) return fmt::format("line {}: a key must be a plain word", line);
      const std::string name = item.first.Scalar();
      ++extent->depth;
      const std::string problem = flatten(item.second, key.empty() ? name : key + "." + name, extent, out);
      --extent->depth;
      if (!problem.empty()) return problem;
    }
    return "";
  }
  if (key.empty()) return fmt::format("line {}: expected `section:` with `name: value` lines below it", line);
  // A list is kept as an empty text: sections of other processes are skipped, and an option of this table refuses the
  // text unless it accepts an empty one.
  out->push_back({key, node.IsScalar() ? node.Scalar() : std::string(), node.IsNull(), line});
  return "";
}

}  // namespace

void OptionTable::insert(Entry entry) {
  if (entry.key.find('.') == std::string::npos) throw std::logic_error("option key without a section: " + entry.key);
  const Field& field = entry.fields.front();
  entry.default_text = value_text(field);
  const bool is_text = std::holds_alternative<std::string*>(field);
  entry.initial = is_text ? *std::get<std::string*>(field) : entry.default_text;
  if (Entry* known = find_in(entries_, entry.key)) {
    const bool alike = describe(*known) == describe(entry) && known->initial == entry.initial;
    if (!alike) throw std::logic_error("option declared twice, and not alike: " + entry.key);
    return known->fields.push_back(field);
  }
  const std::string problem = assign(entry, entry.initial, false);
  if (!problem.empty()) throw std::logic_error("default of an option: " + problem);
  entry.group = group_;
  entries_.push_back(std::move(entry));
}

void OptionTable::for_users(const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    Entry* entry = find_in(entries_, key);
    if (!entry) throw std::logic_error("no such option: " + key);
    entry->is_for_users = true;
  }
}

bool OptionTable::is_meant(const Entry& entry, Which which) {
  return which == Which::kAll || entry.is_for_users == (which == Which::kUsers);
}

void OptionTable::add(const std::string& key, int* field, const std::string& unit, const std::string& help, int min,
                      int max) {
  insert({key, unit, help, {field}, static_cast<double>(min), static_cast<double>(max), {}, {}, {}, {}});
}

void OptionTable::add(const std::string& key, double* field, const std::string& unit, const std::string& help,
                      double min, double max) {
  insert({key, unit, help, {field}, min, max, {}, {}, {}, {}});
}

void OptionTable::add(const std::string& key, bool* field, const std::string& help) {
  insert({key, "", help, {field}, 0, 0, {}, {}, {}, {}});
}

void OptionTable::add(const std::string& key, std::string* field, const std::string& help,
                      const std::vector<std::string>& choices) {
  insert({key, "", help, {field}, 0, 0, choices, {}, {}, {}});
}

const OptionTable::Entry* OptionTable::find(const std::string& key) const { return find_in(entries_, key); }

std::string OptionTable::assign(const Entry& entry, const std::string& text, bool apply) {
  std::string problem;
  for (const Field& field : entry.fields) problem = assign_to(field, entry, text, apply);
  return problem;
}

std::string OptionTable::assign_to(const Field& to, const Entry& entry, const std::string& text, bool apply) {
  const auto number = [&](auto* field) -> std::string {
    using Number = std::remove_pointer_t<decltype(field)>;
    constexpr bool is_int = std::is_same_v<Number, int>;
    const auto value = parse_number<Number>(text);
    const bool ok = value && std::isfinite(static_cast<double>(*value)) && *value >= entry.min && *value <= entry.max;
    if (ok && apply) *field = *value;
    if (ok) return "";
    return fmt::format("{} = {}: expected a {} from {} to {}{}{}", entry.key, quoted(text),
                       is_int ? "whole number" : "number", entry.min, entry.max, entry.unit.empty() ? "" : " ",
                       entry.unit);
  };
  if (const auto* field = std::get_if<int*>(&to)) return number(*field);
  if (const auto* field = std::get_if<double*>(&to)) return number(*field);
  if (const auto* field = std::get_if<bool*>(&to)) {
    const bool yes = text == "true" || text == "yes" || text == "on";
    if (!yes && text != "false" && text != "no" && text != "off")
      return fmt::format("{} = {}: expected true or false", entry.key, quoted(text));
    if (apply) **field = yes;
    return "";
  }
  const bool chosen =
      entry.choices.empty() || std::find(entry.choices.begin(), entry.choices.end(), text) != entry.choices.end();
  if (!chosen)
    return fmt::format("{} = {}: expected one of {}", entry.key, quoted(text), fmt::join(entry.choices, ", "));
  if (apply) *std::get<std::string*>(to) = text;
  return "";
}

std::string OptionTable::unknown(const std::string& key) const {
  std::vector<std::string> keys;
  for (const Entry& entry : entries_) keys.push_back(entry.key);
  const std::string shown = shortened(key);
  if (keys.empty()) return fmt::format("{}: unknown option; this program has none", shown);
  const std::string meant = key_meant_by(key, keys);
  if (meant.empty())
    return fmt::format("{}: unknown option (`rumi config` and `rumi config --expert` list all)", shown);
  return fmt::format("{}: unknown option; did you mean {}?", shown, meant);
}

std::string OptionTable::unknown_section(const std::string& key) const {
  const std::string section = section_of(key);
  if (kKeysOfCalibrations.contains(section))
    return fmt::format(
        "{}: is of a camera's calibration, and options are expected here: give a calibration with --camera FILE",
        shortened(key));
  const bool lacks_section = std::any_of(entries_.begin(), entries_.end(),
                                         [&key](const Entry& entry) { return entry.key.ends_with("." + key); });
  if (lacks_section) return unknown(key);
  std::set<std::string> known = kSectionsOfAll;
  for (const Entry& entry : entries_) known.insert(section_of(entry.key));
  return fmt::format("{}: there is no section {}; did you mean {}?", shortened(key), shortened(section),
                     nearest_word(section, {known.begin(), known.end()}));
}

std::string OptionTable::load_yaml(const std::string& file) {
  errno = 0;
  std::ifstream stream(file);
  std::stringstream text;
  if (stream) text << stream.rdbuf();
  // Asks errno, because an empty file sets failbit of `text` too, and a folder can be opened like a file.
  if (!stream.is_open() || errno != 0)
    return fmt::format("{}: cannot be read ({}): give the YAML file of the options", file, std::strerror(errno));
  return load_yaml_text(text.str(), file);
}

std::string OptionTable::load_yaml_text(const std::string& text, const std::string& name_for_errors) {
  std::vector<FlatValue> values;
  try {
    Extent extent;
    for (const YAML::Node& document : YAML::LoadAll(text)) {
      if (document.IsNull()) continue;
      if (extent.nodes > 0)
        return fmt::format("{}:{}: a second document begins here (behind `---`): remove it, or make one of both",
                           name_for_errors, document.Mark().line + 1);
      const std::string problem = flatten(document, "", &extent, &values);
      if (!problem.empty()) return name_for_errors + ": " + problem;
    }
  } catch (const YAML::Exception& e) {
    return fmt::format("{}:{}: not valid YAML: {}", name_for_errors, e.mark.line + 1, e.msg);
  }

  std::set<std::string> sections, seen;
  for (const Entry& entry : entries_) sections.insert(section_of(entry.key));
  for (const bool apply : {false, true}) {
    for (const FlatValue& value : values) {
      const bool is_own = sections.contains(section_of(value.key));
      if (!is_own && kSectionsOfAll.contains(section_of(value.key))) continue;
      const Entry* entry = find(value.key);
      std::string problem = entry    ? assign(*entry, value.text, apply)
                            : is_own ? unknown(value.key)
                                     : unknown_section(value.key);
      // An empty section (`map_server:` whose lines are all commented out) changes nothing and is no error.
      if (value.is_empty && sections.contains(value.key)) problem.clear();
      if (problem.empty() && !apply && !seen.insert(value.key).second) problem = value.key + ": given twice";
      if (!problem.empty()) return fmt::format("{}:{}: {}", name_for_errors, value.line, problem);
    }
  }
  return "";
}

std::string OptionTable::set(const std::string& setting) {
  const size_t flag_end = setting.starts_with("--") ? setting.find(' ') : std::string::npos;
  const std::string flag = flag_end == std::string::npos ? "--set" : setting.substr(0, flag_end);
  const std::string text = flag_end == std::string::npos ? setting : setting.substr(flag_end + 1);
  const size_t equals = text.find('=');
  if (equals == std::string::npos) return fmt::format("--set {}: expected KEY=VALUE", text);
  const std::string key = text.substr(0, equals);
  const Entry* entry = find(key);
  const std::string problem = entry ? assign(*entry, text.substr(equals + 1), true) : unknown(key);
  if (problem.empty()) return "";
  return flag == "--set" ? "--set " + problem : fmt::format("{}: {}", flag, problem);
}

void OptionTable::reset() {
  for (const Entry& entry : entries_) assign(entry, entry.initial, true);
}

std::string OptionTable::range_text(const Entry& entry) const {
  if (!entry.choices.empty()) {
    const bool may_be_empty = entry.choices[0].empty();
    return (may_be_empty ? "\"\"" : "") + fmt::format("{}", fmt::join(entry.choices, " | "));
  }
  const bool is_number =
      std::holds_alternative<int*>(entry.fields.front()) || std::holds_alternative<double*>(entry.fields.front());
  return is_number ? fmt::format("{} .. {}", entry.min, entry.max) : "";
}

std::string OptionTable::describe(const Entry& entry) const {
  const std::string range = range_text(entry);
  return fmt::format("{}{}{}{}", entry.help, entry.unit.empty() ? "" : ", " + entry.unit, range.empty() ? "" : " (",
                     range.empty() ? "" : range + ")");
}

std::string OptionTable::help(Which which) const {
  std::string text;
  for (const Entry& entry : entries_)
    if (is_meant(entry, which))
      text += fmt::format("{:<{}} {}\n", fmt::format("  {} = {}", entry.key, entry.default_text), kHelpColumn,
                          describe(entry));
  return text;
}

std::string OptionTable::to_yaml(Which which) const {
  std::vector<std::string> sections;
  for (const Entry& entry : entries_)
    if (is_meant(entry, which) && std::find(sections.begin(), sections.end(), section_of(entry.key)) == sections.end())
      sections.push_back(section_of(entry.key));
  std::string text;
  for (const std::string& section : sections) {
    text += section + ":\n";
    std::string group;
    for (const Entry& entry : entries_) {
      if (section_of(entry.key) != section || !is_meant(entry, which)) continue;
      if (which == Which::kExperts && entry.group != group) text += fmt::format("  # {}\n", entry.group);
      group = entry.group;
      // The part of the key behind the section may contain dots; load_yaml() accepts that.
      const std::string name = entry.key.substr(section.size() + 1);
      text += fmt::format("{:<{}} # {}\n", fmt::format("  {}: {}", name, value_text(entry.fields.front())), kHelpColumn,
                          describe(entry));
    }
  }
  return text;
}

std::string by_flag(const std::string& flag, const std::string& key, const std::string& value) {
  return fmt::format("{} {}={}", flag, key, value);
}

std::string load_options(OptionTable& table, const std::string& config_file, const std::vector<std::string>& settings) {
  if (!config_file.empty()) {
    if (std::string error = table.load_yaml(config_file); !error.empty()) return error;
  }
  for (const std::string& setting : settings) {
    if (std::string error = table.set(setting); !error.empty()) return error;
  }
  return "";
}

}  // namespace rumi
