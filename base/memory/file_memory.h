// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <memory_resource>
#include <mutex>
#include <string>
#include <vector>

#include "base/files/file_descriptor.h"

namespace rumi {

// Memory for what is kept long and seldom used. It lies in a file without a name, so the system keeps in RAM only the
// pages in use, and others as long as there is room. May be used from several threads.
class FileMemory : public std::pmr::memory_resource {
 public:
  // The file is made in `folder` when it is first needed. Where that fails, or the disk is full, ordinary memory is
  // used, and a warning says so once.
  explicit FileMemory(std::string folder);
  ~FileMemory() override;
  FileMemory(const FileMemory&) = delete;
  FileMemory& operator=(const FileMemory&) = delete;

  // Returns the process's own, in which the features of keyframes lie.
  static FileMemory& of_process();

  // Releases the RAM, not the contents: a page comes back when it is used. Costs a few system calls.
  void let_go();
  size_t file_bytes() const;  // size of the file

  // Returns the environment variable TMPDIR, or else /var/tmp, which is on a disk where /tmp may be in RAM.
  static std::string usual_folder();

 private:
  void* do_allocate(size_t bytes, size_t alignment) override;
  void do_deallocate(void* memory, size_t bytes, size_t alignment) override;
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  // Returns nullptr if the file cannot grow.
  void* take_pages(size_t pages);
  bool grow(size_t pages);
  bool make_file();
  void give_up(const std::string& reason);
  bool is_in_file(const void* memory) const;

  struct Segment {
    std::byte* begin;
    size_t bytes;
  };

  mutable std::mutex mutex_;
  std::string folder_;
  FileDescriptor file_;
  size_t file_bytes_ = 0;
  bool gave_up_ = false;
  std::vector<Segment> segments_;                   // parts of the file, as they are mapped
  std::map<size_t, std::vector<std::byte*>> free_;  // by number of pages
};

}  // namespace rumi
