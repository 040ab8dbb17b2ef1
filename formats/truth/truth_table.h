// SPDX-License-Identifier: BSD-3-Clause
// The text of a truth as a table: lines of fields, whatever is between them, and what the columns are.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace rumi {

struct TruthLine {
  int number = 0;  // in the file
  std::vector<std::string> fields;
};

struct TruthTable {
  std::vector<TruthLine> lines;    // without comments and the line that names the columns
  std::vector<std::string> names;  // names of the columns, in lower case; empty if they are not named
  size_t columns = 0;              // number of columns of most lines
  bool has_commas = false;         // between the fields
};

// Returns nothing if the file cannot be read.
std::optional<TruthTable> read_truth_table(const std::string& file);

// The columns of the parts of a pose.
struct TruthColumns {
  std::optional<size_t> time;                       // without times, poses are in the order of the images
  std::array<size_t, 3> position = {};              // x y z
  std::optional<std::array<size_t, 4>> quaternion;  // w x y z
  std::optional<size_t> matrix;                     // the first of twelve numbers, three rows of four
  size_t count() const;                             // how many fields a line must have
};

// Finds the columns by their names, else by their number. Nothing, and why in *error, if they cannot be those of a
// truth. is_euroc: a quaternion without names begins with w.
std::optional<TruthColumns> find_columns(const TruthTable& table, bool is_euroc, std::string* error);

}  // namespace rumi
