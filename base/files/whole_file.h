// SPDX-License-Identifier: BSD-3-Clause
// A file that appears whole or not at all, and survives a power cut once it is there: written under a temporary name
// beside it, renamed at the end.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace rumi {

class WholeFile {
 public:
  explicit WholeFile(const std::string& file);
  ~WholeFile();  // without commit() nothing remains
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  // Errors are kept for commit().
  void write(std::string_view bytes);
  // What was written there before; write() goes on at the end.
  void overwrite(int64_t at, std::string_view bytes);
  template <class T>
  void write_value(const T& value) {  // as it lies in memory (little endian)
    write({reinterpret_cast<const char*>(&value), sizeof(value)});
  }
  // Empty, or the name of the file and why it could not be written.
  std::string commit();
  const std::string& problem() const { return problem_; }  // so far, as commit() would tell it

 private:
  void note_error();

  std::string file_, temporary_, problem_;
  std::FILE* stream_ = nullptr;
};

// For those who cannot write through WholeFile: a name beside `file` that no other process writes to ...
std::string temporary_name(const std::string& file);
// ... and the end of it: brings the finished temporary file to the disk and gives it its name. Returns what went wrong
// (then the temporary file is gone), or an empty string.
std::string commit_file(const std::string& temporary, const std::string& file);

}  // namespace rumi
