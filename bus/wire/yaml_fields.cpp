// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/yaml_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include "base/text/number_text.h"

namespace rumi {
namespace {

constexpr int kDeepest = 8;
constexpr size_t kMostFields = 5000;
constexpr size_t kMostNodes = 65536;  // with anchors, a few bytes of YAML can stand for any number of nodes
constexpr size_t kMostValues = 64;    // in a list: the longest real one has 16
constexpr size_t kMostNamed = 8;
constexpr const char* kTooManyFields = "has too many fields for a camera calibration";

std::optional<double> number_in(const YAML::Node& node) {
  return node.IsScalar() ? parse_number<double>(without_plus(node.Scalar())) : std::nullopt;
}

std::string quoted_node(const YAML::Node& node) {
  if (!node.IsScalar()) return node.IsMap() ? "a group" : node.IsSequence() ? "a list" : "empty";
  const std::string& text = node.Scalar();
  return text.size() > 40 ? fmt::format("'{}...'", text.substr(0, 40)) : fmt::format("'{}'", text);
}

// True if the node has more than *left nodes, itself included. Reduces *left by those that it visits, down to the depth
// that Fields reads.
bool has_more_nodes_than(size_t* left, const YAML::Node& node, int depth) {
  if (*left == 0) return true;
  --*left;
  if (depth > 2 * kDeepest + 2 || (!node.IsMap() && !node.IsSequence())) return false;
  return std::any_of(node.begin(), node.end(), [left, depth, is_map = node.IsMap()](const auto& entry) {
    return has_more_nodes_than(left, is_map ? entry.second : entry, depth + 1);
  });
}

bool holds_groups(const YAML::Node& list, int depth) {
  if (depth > kDeepest) return false;
  for (size_t i = 0; i < std::min(list.size(), kMostValues); ++i)
    if (list[i].IsMap() || (list[i].IsSequence() && holds_groups(list[i], depth + 1))) return true;
  return false;
}

// True if the last part of the name is a number of the optics: one that the equations of a camera model use.
bool is_optics(const std::string& name) {
  static const std::set<std::string> kOptics = {"k1", "k2", "k3", "k4",   "k5",    "k6",   "p1",    "p2", "p3", "p4",
                                                "s1", "s2", "s3", "s4",   "taux",  "tauy", "omega", "xi", "b1", "b2",
                                                "w",  "s",  "fx", "skew", "alpha", "beta", "fy",    "cx", "cy"};
  return kOptics.contains(name.substr(name.rfind('.') + 1));
}

// Puts a space behind the colon of "data:[1, 2" and "Camera.fx:500".
std::string with_spaces(const std::string& text) {
  std::string spaced;
  bool in_key = true;  // nothing but a name so far in this line
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    spaced += c;
    if (in_key && c == ':' && i + 1 < text.size() && std::isspace(static_cast<unsigned char>(text[i + 1])) == 0)
      spaced += ' ';
    const bool is_of_name = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == ' ';
    in_key = c == '\n' || (in_key && is_of_name);
  }
  return spaced;
}

}  // namespace

YAML::Node load_yaml(std::string text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  // OpenCV's "%YAML:1.0" is no directive of YAML's, and OpenCV needs no space behind a key's colon.
  if (text.starts_with("%YAML")) text = with_spaces(text.erase(0, text.find('\n')));
  if (text.find_first_not_of(" \t\r\n") != std::string::npos && text[text.find_first_not_of(" \t\r\n")] == '{')
    std::replace(text.begin(), text.end(), '\t', ' ');  // JSON may be indented with tabs, YAML may not
  return YAML::Load(text);
}

bool is_side(double value) { return value == std::floor(value) && std::abs(value) <= 1e6; }

Fields::Fields(const YAML::Node& root, std::string file) : file_(std::move(file)) {
  size_t left = kMostNodes;
  if (has_more_nodes_than(&left, root, 0))
    fail(kTooManyFields);
  else
    flatten(root, "", 0);
}

void Fields::add(const std::string& name, const YAML::Node& node) {
  if (!values_.emplace(name, node).second)
    twice_.insert(name);
  else
    order_.push_back(name);
}

void Fields::flatten(const YAML::Node& node, const std::string& name, int depth) {
  if (order_.size() > kMostFields) return fail(kTooManyFields);
  if (depth <= kDeepest && node.IsMap()) {
    for (const auto& entry : node) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
      flatten(entry.second, name.empty() ? key : name + "." + key, depth + 1);
    }
  } else if (depth <= kDeepest && node.IsSequence() && holds_groups(node, 0)) {
    for (size_t i = 0; i < std::min(node.size(), kMostValues); ++i)
      flatten(node[i], fmt::format("{}[{}]", name, i), depth + 1);
  } else {
    add(name, node);
  }
}

Fields Fields::group(const std::string& prefix) const {
  Fields part = *this;
  part.notes_.clear();
  part.prefix_ = prefix_ + prefix;
  std::erase_if(part.order_, [&part](const std::string& name) { return !name.starts_with(part.prefix_); });
  return part;
}

void Fields::fail(const std::string& what) {
  if (!error_) error_ = Error{what, file_};
}

void Fields::note(const std::string& what) { notes_.push_back(fmt::format("{}: {}", file_, what)); }

bool Fields::has_any(const std::string& prefix) const {
  const auto found = values_.lower_bound(prefix_ + prefix);
  return found != values_.end() && found->first.starts_with(prefix_ + prefix);
}

std::vector<std::string> Fields::names() const { return order_; }

std::string Fields::spelling(std::initializer_list<const char*> keys) const {
  const auto found = std::find_if(keys.begin(), keys.end(), [this](const char* key) { return has(key); });
  return found == keys.end() ? *keys.begin() : *found;
}

const YAML::Node* Fields::find(const std::string& key) {
  const std::string name = prefix_ + key;
  const auto found = values_.find(name);
  if (found == values_.end()) return nullptr;
  used_.insert(name);
  if (twice_.contains(name)) fail(fmt::format("{} is given twice: remove one", name));
  return &found->second;
}

double Fields::to_number(const YAML::Node& node, const std::string& name, const std::string& meaning) {
  const std::optional<double> value = number_in(node);
  if (value && std::isfinite(*value)) return *value;
  fail(fmt::format("{} is {}: must be a finite number ({})", name, quoted_node(node), meaning));
  return 0;
}

double Fields::number(const std::string& key, const std::string& meaning) {
  const YAML::Node* node = find(key);
  if (node && !node->IsNull()) return to_number(*node, full(key), meaning);
  fail(fmt::format("{} is missing: add '{}: <{}>'", full(key), full(key), meaning));
  return 0;
}

double Fields::optional_number(const std::string& key) {
  const YAML::Node* node = find(key);
  return node && !node->IsNull() ? to_number(*node, full(key), "a distortion coefficient or rate") : 0;
}

int Fields::size(const std::string& key) {
  const double value = number(key, "pixels");
  if (is_side(value)) return static_cast<int>(value);
  fail(fmt::format("{} is {}: must be a whole number of pixels", full(key), quoted(key)));
  return 0;
}

void Fields::append(const YAML::Node& node, const std::string& name, const std::string& meaning, int depth,
                    std::vector<double>* values) {
  if (values->size() > kMostValues) return fail(fmt::format("{} has too many values ({})", name, meaning));
  if (!node.IsSequence() || depth > kDeepest) return values->push_back(to_number(node, name, meaning));
  for (size_t i = 0; i < std::min(node.size(), kMostValues + 1); ++i)
    append(node[i], fmt::format("{}[{}]", name, i), meaning, depth + 1, values);
}

std::vector<double> Fields::list(const std::string& key, const std::string& meaning) {
  std::vector<double> values;
  const YAML::Node* node = find(key);
  if (!node || node->IsNull())
    fail(fmt::format("{} is missing: add '{}: [{}]'", full(key), full(key), meaning));
  else if (!node->IsSequence())
    fail(fmt::format("{} is {}: must be a list [{}]", full(key), quoted_node(*node), meaning));
  else
    append(*node, full(key), meaning, 0, &values);
  return values;
}

std::vector<double> Fields::list(const std::string& key, const std::string& meaning, size_t count) {
  std::vector<double> values = list(key, meaning);
  if (!error_ && values.size() != count)
    fail(fmt::format("{} has {} values: must have {} ({})", full(key), values.size(), count, meaning));
  values.resize(count);
  return values;
}

std::string Fields::text(const std::string& key, const std::string& otherwise) {
  const YAML::Node* node = find(key);
  return node && node->IsScalar() ? node->Scalar() : otherwise;
}

std::string Fields::quoted(const std::string& key) const {
  const auto found = values_.find(prefix_ + key);
  return found == values_.end() ? "not there" : quoted_node(found->second);
}

void Fields::pass_over(std::initializer_list<const char*> beginnings) {
  for (const std::string& name : order_) {
    const std::string key = name.substr(prefix_.size());
    if (std::any_of(beginnings.begin(), beginnings.end(), [&key](const char* b) { return key.starts_with(b); }))
      used_.insert(name);
  }
}

void Fields::tell_unused() {
  std::vector<std::string> unused;
  for (const std::string& name : order_) {
    const bool is_form_of_matrix = name.ends_with(".rows") || name.ends_with(".cols") || name.ends_with(".dt");
    if (used_.contains(name) || is_form_of_matrix) continue;
    const YAML::Node& node = values_.at(name);
    const std::optional<double> value = number_in(node);
    if (is_optics(name) && value == 0) continue;
    if (is_optics(name) && value)
      return fail(
          fmt::format("{} is {}, and the camera's model here has no such coefficient: correct the model, calibrate "
                      "again without it, or remove it if it belongs to something else",
                      name, quoted_node(node)));
    unused.push_back(name);
  }
  if (unused.empty()) return;
  const size_t more = unused.size() - std::min(unused.size(), kMostNamed);
  unused.resize(unused.size() - more);
  note(fmt::format("not used of it: {}{}", fmt::join(unused, ", "), more > 0 ? fmt::format(" and {} more", more) : ""));
}

Result<Fields> fields_of_text(const std::string& text, const std::string& name, const std::string& expected) {
  const auto refuse = [&](const std::string& why) { return Error{why, name}; };
  const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
  if (text.size() > kMaxYamlBytes)
    return refuse(fmt::format("is longer than {} bytes: not a camera calibration; {}", kMaxYamlBytes, expected));
  if (std::all_of(text.begin(), text.end(), is_space)) return refuse(fmt::format("is empty: {}", expected));
  if (std::any_of(text.begin(), text.end(), [&](unsigned char c) { return c < 0x20 && !is_space(c); }))
    return refuse(fmt::format("is not a text file: {}", expected));
  try {
    const YAML::Node root = load_yaml(text);
    if (!root.IsMap()) return refuse(fmt::format("is not a list of 'key: value': {}", expected));
    return Fields(root, name);
  } catch (const YAML::Exception& e) {
    return refuse(fmt::format("is not correct YAML (line {}: {}): {}", e.mark.line + 1, e.msg, expected));
  }
}

}  // namespace rumi
