// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace rumi {

// Reads a text file line by line, whatever ends a line: LF, CR LF, or CR alone. Skips UTF-8's byte order mark.
class TextLines {
 public:
  explicit TextLines(const std::filesystem::path& file);  // see error()

  // Reads the next line. Returns false at the end. A line that is longer than any in a list is cut.
  bool next(std::string* line);
  // Says why the file cannot be read, and what to do, without the name of the file; empty if it can.
  const std::string& error() const { return error_; }

 private:
  std::ifstream stream_;
  std::string error_;
};

}  // namespace rumi
