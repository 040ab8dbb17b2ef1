// SPDX-License-Identifier: BSD-3-Clause
// A file that appears whole or not at all: written under a temporary name beside it, renamed at the end.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace rumi {

class OutputFile {
 public:
  explicit OutputFile(const std::string& file);
  ~OutputFile();  // without commit() nothing remains
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Errors are kept for commit().
  void write(std::string_view bytes);
  template <class T>
  void write_value(const T& value) {  // as it lies in memory (little endian)
    write({reinterpret_cast<const char*>(&value), sizeof(value)});
  }
  // Empty, or the name of the file and why it could not be written.
  std::string commit();

 private:
  void note_error();

  std::string file_, temporary_, problem_;
  std::FILE* stream_ = nullptr;
};

}  // namespace rumi
