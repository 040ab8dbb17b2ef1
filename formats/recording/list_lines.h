// SPDX-License-Identifier: BSD-3-Clause
// Reads the lines of a list of images: "time name", with any separator.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "formats/recording/file_list.h"

namespace rumi {

// The parts of a line as they are written.
struct ListLine {
  std::string time, name;
  int number = 0;
  size_t images = 1;     // how many images the line names
  bool is_first = true;  // `name` is the first of these images
  bool has_decimal_comma = false;
};

// Any of these stands between a time and a name.
inline constexpr const char* kSeparators = " \t,;";

// Splits "time name" at any separator.
void split_line(const std::string& text, ListLine* line);

// Splits a line that is no comment into its parts. An Error says what is wrong with it.
using LineParser = std::function<Result<>(const std::string& text, ListLine* line)>;

// Returns the Error of a line without a name.
Error no_name_after(const std::string& time);
void add_malformed(FileList* list, int line, const std::string& problem);
// Reads the lines of the list. Those that `parse` refuses are counted as malformed. An Error if the file cannot be
// read.
Result<std::vector<ListLine>> read_lines(FileList* list, const LineParser& parse);
// Removes lines that repeat an earlier one: some recorders write a line twice.
std::vector<ListLine> without_repeats(FileList* list, std::vector<ListLine> lines);
// Adds notes on lines that name several images, and on decimal commas.
void tell_of_lines(FileList* list, const std::vector<ListLine>& lines);

// Returns the text, cut short, with '?' for control characters, so that a binary file cannot upset the terminal.
std::string printable(const std::string& text);

}  // namespace rumi
