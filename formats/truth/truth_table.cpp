// SPDX-License-Identifier: BSD-3-Clause
#include "formats/truth/truth_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "formats/truth/text_fields.h"

namespace rumi {
namespace {

// Splits a line into fields, without the quotes around them.
std::vector<std::string> fields_of(const std::string& line) {
  if (line.find(';') == std::string::npos) return split(line, " ,\t\r\"'");
  // If semicolons separate the fields, a comma is a decimal comma.
  std::vector<std::string> fields = split(line, " ;\t\r\"'");
  for (std::string& field : fields)
    if (std::count(field.begin(), field.end(), ',') == 1) std::replace(field.begin(), field.end(), ',', '.');
  return fields;
}

bool is_comment(const std::string& line) {
  const size_t first = line.find_first_not_of(" \t\r\"'");
  return first == std::string::npos || line[first] == '#' || line[first] == '%' || line.compare(first, 2, "//") == 0;
}

// Reads the names of columns: "#timestamp [ns], p_RS_R_x [m]" are two names; so are "time tx".
std::vector<std::string> names_of(std::string line) {
  for (size_t open = line.find('['); open != std::string::npos; open = line.find('[')) {
    const size_t close = line.find(']', open);
    line.erase(open, close == std::string::npos ? close : close - open + 1);
  }
  for (char& c : line) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return split(line, " ,;\t\r\"'#%/");
}

bool is_a_word(const std::string& field) {
  static constexpr const char* kNoWords[] = {"nan", "inf", "none", "null", "nat"};
  std::string text = field;
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const bool begins_with_letter =
      !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0])) || text[0] == '_');
  return begins_with_letter && std::none_of(std::begin(kNoWords), std::end(kNoWords),
                                            [&text](const char* word) { return text.starts_with(word); });
}

bool holds(const std::string& name, std::initializer_list<const char*> pieces) {
  return std::any_of(pieces.begin(), pieces.end(),
                     [&name](const char* piece) { return name.find(piece) != std::string::npos; });
}

// Returns "time", "x" to "z" for the position, "qw" to "qz"; empty for other columns.
std::string role_of(const std::string& name) {
  if (name == "t" || name == "sec" || name == "secs" || name == "seconds" || holds(name, {"time", "stamp"}))
    return "time";
  const char last = name.empty() ? ' ' : name.back();
  if (last < 'w' || last > 'z') return "";
  if (holds(name, {"vel", "acc", "gyr", "omega", "angular", "twist", "cov", "std", "sigma"}) ||
      name.starts_with("v_") || name.starts_with("b_"))
    return "";
  if (name.starts_with("q") || name == "w" || holds(name, {"quat", "orient", "rotation", ".q"}))
    return std::string("q") + last;
  const bool is_position =
      name.size() == 1 || name.starts_with("t") || name.starts_with("p") || holds(name, {"pos", "trans"});
  return is_position && last != 'w' ? std::string(1, last) : "";
}

std::optional<TruthColumns> columns_by_name(const std::vector<std::string>& names) {
  std::map<std::string, size_t> roles;
  for (size_t i = 0; i < names.size(); ++i)
    if (const std::string role = role_of(names[i]); !role.empty()) roles.emplace(role, i);
  for (const char* needed : {"time", "x", "y", "z"})
    if (!roles.contains(needed)) return std::nullopt;
  TruthColumns columns;
  columns.time = roles["time"];
  columns.position = {roles["x"], roles["y"], roles["z"]};
  const bool has_rotation =
      roles.contains("qw") && roles.contains("qx") && roles.contains("qy") && roles.contains("qz");
  if (has_rotation) columns.quaternion = {roles["qw"], roles["qx"], roles["qy"], roles["qz"]};
  return columns;
}

// True for lines of seven numbers of which the last four are a rotation: poses without times.
bool are_poses_without_times(const TruthTable& table) {
  size_t rotations = 0;
  for (const TruthLine& line : table.lines) {
    double norm = 0;
    for (size_t i = 3; i < std::min<size_t>(line.fields.size(), 7); ++i)
      norm += std::pow(to_number(line.fields[i]).value_or(0), 2);
    rotations += line.fields.size() == 7 && std::abs(norm - 1) < 0.02;
  }
  return 10 * rotations > 9 * table.lines.size();
}

// True for matrices over four lines each, which have a line 0 0 0 1 (7-Scenes, ScanNet, Redwood's .log).
bool are_matrices_over_lines(const TruthTable& table) {
  const auto is_last_row = [](const TruthLine& line) {
    if (line.fields.size() != 4) return false;
    for (size_t i = 0; i < 4; ++i)
      if (to_number(line.fields[i]) != (i < 3 ? 0.0 : 1.0)) return false;
    return true;
  };
  const auto rows = std::count_if(table.lines.begin(), table.lines.end(), is_last_row);
  return table.columns == 4 && 5 * static_cast<size_t>(rows) >= table.lines.size() && rows > 0;
}

bool is_whole(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

// Finds the column of whole seconds that a column of nanoseconds follows, as in ROS: by the names of the columns;
// without names, the first two columns, if these are whole numbers of ten digits (since 1970) and of at most nine.
// Returns nullopt if there are no such columns.
std::optional<size_t> column_of_seconds(const TruthTable& table) {
  for (size_t i = 0; i + 1 < table.names.size() && table.names.size() == table.columns; ++i)
    if (holds(table.names[i], {"sec"}) && holds(table.names[i + 1], {"nsec", "nanosec"})) return i;
  constexpr size_t kDigitsOfSeconds = 10, kMostDigits = 9, kLeastColumns = 5;
  if (!table.names.empty() || table.columns < kLeastColumns) return std::nullopt;
  size_t fitting = 0, long_ones = 0;
  for (const TruthLine& line : table.lines) {
    if (line.fields.size() != table.columns || !is_whole(line.fields[0]) || !is_whole(line.fields[1])) continue;
    fitting += line.fields[0].size() == kDigitsOfSeconds && line.fields[1].size() <= kMostDigits;
    long_ones += line.fields[1].size() + 1 >= kMostDigits;
  }
  return 10 * fitting > 9 * table.lines.size() && 2 * long_ones > table.lines.size() ? std::optional(size_t{0})
                                                                                     : std::nullopt;
}

// Joins the parts of a time, so that each line has one field for it.
void join_seconds(TruthTable* table) {
  const std::optional<size_t> seconds = column_of_seconds(*table);
  if (!seconds) return;
  for (TruthLine& line : table->lines) {
    if (line.fields.size() != table->columns) continue;
    const std::string nanoseconds = line.fields[*seconds + 1];
    if (nanoseconds.size() <= 9) line.fields[*seconds] += "." + std::string(9 - nanoseconds.size(), '0') + nanoseconds;
    line.fields.erase(line.fields.begin() + static_cast<std::ptrdiff_t>(*seconds) + 1);
  }
  if (!table->names.empty()) {
    table->names[*seconds] = "time";
    table->names.erase(table->names.begin() + static_cast<std::ptrdiff_t>(*seconds) + 1);
  }
  --table->columns;
}

std::optional<TruthColumns> columns_by_number(const TruthTable& table, bool is_euroc) {
  const size_t n = table.columns;
  TruthColumns columns;
  if (n == 12 || n == 16) {
    columns.matrix = 0;
  } else if ((n == 13 || n == 17) && !is_euroc) {
    columns.time = 0, columns.matrix = 1;
  } else if (n == 7 && are_poses_without_times(table)) {
    columns.position = {0, 1, 2}, columns.quaternion = {6, 3, 4, 5};
  } else if (n == 3) {
    columns.position = {0, 1, 2};
  } else if (n >= 4) {
    columns.time = 0, columns.position = {1, 2, 3};
    if (n >= 8 && is_euroc) columns.quaternion = {4, 5, 6, 7};
    if (n >= 8 && !is_euroc) columns.quaternion = {7, 4, 5, 6};
  } else {
    return std::nullopt;
  }
  return columns;
}

}  // namespace

size_t TruthColumns::count() const {
  size_t last = *std::max_element(position.begin(), position.end());
  if (time) last = std::max(last, *time);
  if (quaternion) last = std::max(last, *std::max_element(quaternion->begin(), quaternion->end()));
  if (matrix) last = std::max(last, *matrix + 11);
  return last + 1;
}

std::optional<TruthTable> read_truth_table(const std::string& file) {
  std::ifstream in(file);
  std::error_code code;
  if (!in || std::filesystem::is_directory(file, code)) return std::nullopt;
  TruthTable table;
  std::vector<std::string> comment;
  std::map<size_t, size_t> counts;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    if (++number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (is_comment(line)) {
      if (table.lines.empty() && names_of(line).size() >= 4) comment = names_of(line);
      continue;
    }
    std::vector<std::string> fields = fields_of(line);
    if (table.lines.empty() && table.names.empty() && fields.size() >= 3 && is_a_word(fields[0])) {
      table.names = names_of(line);
      continue;
    }
    table.has_commas = table.has_commas || line.find(',') != std::string::npos;
    ++counts[fields.size()];
    table.lines.push_back({number, std::move(fields)});
  }
  for (const auto& [columns, lines] : counts)
    if (table.columns == 0 || lines > counts[table.columns]) table.columns = columns;
  // A comment with as many words as there are columns names the columns.
  if (table.names.empty() && comment.size() == table.columns) table.names = comment;
  join_seconds(&table);
  return table;
}

std::optional<TruthColumns> find_columns(const TruthTable& table, bool is_euroc, std::string* error) {
  const bool is_on_the_globe = std::any_of(table.names.begin(), table.names.end(),
                                           [](const std::string& name) { return name.starts_with("lat"); });
  if (is_on_the_globe) {
    *error = "has latitudes: convert them to metres (x y z), as with UTM";
    return std::nullopt;
  }
  if (are_matrices_over_lines(table)) {
    *error = "has matrices over four lines each: write the 12 or 16 numbers of a pose into one line";
    return std::nullopt;
  }
  if (table.names.size() == table.columns)
    if (auto columns = columns_by_name(table.names)) return columns;
  auto columns = columns_by_number(table, is_euroc);
  if (!columns)
    *error = fmt::format(
        "none of {} lines is a pose: they have {} numbers; read are TUM's 8 (time tx ty tz qx qy qz qw), "
        "EuRoC's, KITTI's 12, and 4 (time x y z)",
        table.lines.size(), table.columns);
  return columns;
}

}  // namespace rumi
