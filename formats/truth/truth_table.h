// SPDX-License-Identifier: BSD-3-Clause
// Reads the text of a truth as a table of lines and fields, with any separators, and finds out what its columns are.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace rumi {

struct TruthLine {
  int number = 0;  // number of the line in the file, from 1
  std::vector<std::string> fields;
};

struct TruthTable {
  std::vector<TruthLine> lines;    // without comments and the line that names the columns
  std::vector<std::string> names;  // names of the columns, in lower case; empty if they are not named
  size_t columns = 0;              // number of columns of most lines
  bool has_commas = false;         // fields are separated by commas
};

// Returns nullopt if the file cannot be read.
std::optional<TruthTable> read_truth_table(const std::string& file);

// The columns that hold the parts of a pose.
struct TruthColumns {
  std::optional<size_t> time;                       // nullopt: no times, the poses are in the order of the images
  std::array<size_t, 3> position = {};              // x y z
  std::optional<std::array<size_t, 4>> quaternion;  // w x y z
  std::optional<size_t> matrix;                     // the first of twelve numbers, three rows of four
  size_t count() const;                             // how many fields a line must have
};

// Finds the columns by their names, else by how many there are. Returns nullopt, with the reason in *error, if they
// cannot be those of a truth. `is_euroc`: a quaternion without names begins with w.
std::optional<TruthColumns> find_columns(const TruthTable& table, bool is_euroc, std::string* error);

}  // namespace rumi
