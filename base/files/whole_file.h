// SPDX-License-Identifier: BSD-3-Clause
// A file that appears complete or not at all, and survives a power cut once it is there. It is written under a
// temporary name in the same folder and renamed at the end.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "base/result.h"

namespace rumi {

class WholeFile {
 public:
  explicit WholeFile(const std::string& file);
  ~WholeFile();  // without commit(), removes the temporary file; a file that was there before stays as it was
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  // If it fails, commit() returns the Error.
  void write(std::string_view bytes);
  // Replaces bytes that were written before. The next write() appends at the end again.
  void overwrite(int64_t at, std::string_view bytes);
  template <class T>
  void write_value(const T& value) {  // writes it as it is in memory (little endian)
    write({reinterpret_cast<const char*>(&value), sizeof(value)});
  }
  // Brings the file to the disk and renames it. An Error names the file and the first failure since it was opened.
  Result<> commit();
  const Result<>& so_far() const { return so_far_; }  // the result of commit() if nothing else fails

 private:
  void note_error();

  std::string file_, temporary_;
  Result<> so_far_;
  std::FILE* stream_ = nullptr;
};

// Returns an unused name beside `file`, for writers that cannot use WholeFile. They end with commit_file().
std::string temporary_name(const std::string& file);
// Brings the finished temporary file to the disk and renames it to `file`. If it returns an Error, it has removed the
// temporary file.
Result<> commit_file(const std::string& temporary, const std::string& file);

}  // namespace rumi
