// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace rumi {

// A text file line by line, whatever ends a line: LF, CR LF, or CR alone. Without the mark of UTF-8.
class TextLines {
 public:
  explicit TextLines(const std::filesystem::path& file);  // see error()

  // False at the end. Of a line that is longer than any of a list the beginning.
  bool next(std::string* line);
  // Says why the file cannot be read, and what to do, without the name of the file; empty if it can.
  const std::string& error() const { return error_; }

 private:
  std::ifstream stream_;
  std::string error_;
};

}  // namespace rumi
