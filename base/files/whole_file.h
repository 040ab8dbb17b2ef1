// SPDX-License-Identifier: BSD-3-Clause
// A file that appears whole or not at all, and survives a power cut once it is there: it is written under a temporary
// name in the same folder, and renamed at the end.
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
  ~WholeFile();  // without commit() nothing remains
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  // Errors are kept for commit().
  void write(std::string_view bytes);
  // Replaces bytes that were written before; write() goes on at the end.
  void overwrite(int64_t at, std::string_view bytes);
  template <class T>
  void write_value(const T& value) {  // as it lies in memory (little endian)
    write({reinterpret_cast<const char*>(&value), sizeof(value)});
  }
  // Brings the file to the disk. An Error names the file and the first failure since it was opened.
  Result<> commit();
  const Result<>& so_far() const { return so_far_; }  // what commit() would return now, if nothing else fails

 private:
  void note_error();

  std::string file_, temporary_;
  Result<> so_far_;
  std::FILE* stream_ = nullptr;
};

// A name beside `file` that no other process uses, for writers that need a file of their own instead of a WholeFile ...
std::string temporary_name(const std::string& file);
// ... and the last step, which brings the finished temporary file to the disk and renames it to `file`. After an Error
// the temporary file is gone.
Result<> commit_file(const std::string& temporary, const std::string& file);

}  // namespace rumi
