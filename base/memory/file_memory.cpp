// SPDX-License-Identifier: BSD-3-Clause
#include "base/memory/file_memory.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "base/running/log.h"

namespace rumi {
namespace {

constexpr size_t kPage = 4096;
constexpr size_t kSegmentPages = 2048;  // the file grows by as many pages at once, at least

size_t pages_of(size_t bytes) { return (bytes + kPage - 1) / kPage; }

}  // namespace

FileMemory::FileMemory(std::string folder) : folder_(std::move(folder)) {}

FileMemory::~FileMemory() {
  for (const Segment& segment : segments_) munmap(segment.begin, segment.bytes);
}

std::string FileMemory::usual_folder() {
  const char* folder = std::getenv("TMPDIR");
  return folder && *folder ? folder : "/var/tmp";
}

FileMemory& FileMemory::of_process() {
  // Never destroyed, because what lies in it may outlive every object with a destructor.
  static auto* memory = new FileMemory(usual_folder());
  return *memory;
}

void FileMemory::let_go() {
  const std::scoped_lock lock(mutex_);
  for (const Segment& segment : segments_) madvise(segment.begin, segment.bytes, MADV_DONTNEED);
}

size_t FileMemory::file_bytes() const {
  const std::scoped_lock lock(mutex_);
  return file_bytes_;
}

void* FileMemory::do_allocate(size_t bytes, size_t alignment) {
  if (bytes > 0 && alignment <= kPage) {
    const std::scoped_lock lock(mutex_);
    if (void* memory = take_pages(pages_of(bytes))) return memory;
  }
  return std::pmr::new_delete_resource()->allocate(bytes, alignment);
}

void FileMemory::do_deallocate(void* memory, size_t bytes, size_t alignment) {
  {
    const std::scoped_lock lock(mutex_);
    if (is_in_file(memory)) {
      free_[pages_of(bytes)].push_back(static_cast<std::byte*>(memory));
      return;
    }
  }
  std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
}

// Takes the smallest free piece that is large enough, and keeps the rest of it as a free piece.
void* FileMemory::take_pages(size_t pages) {
  auto found = free_.lower_bound(pages);
  if (found == free_.end()) {
    if (!grow(std::max(pages, kSegmentPages))) return nullptr;
    found = free_.lower_bound(pages);
  }
  const size_t had = found->first;
  std::byte* memory = found->second.back();
  found->second.pop_back();
  if (found->second.empty()) free_.erase(found);
  if (had > pages) free_[had - pages].push_back(memory + pages * kPage);
  return memory;
}

bool FileMemory::grow(size_t pages) {
  if (gave_up_ || (!file_ && !make_file())) return false;
  const size_t bytes = pages * kPage;
  // The blocks are reserved now: a page that found no room on the disk later would end the process (SIGBUS).
  if (const int error = posix_fallocate(file_.get(), static_cast<off_t>(file_bytes_), static_cast<off_t>(bytes))) {
    give_up(std::strerror(error));
    return false;
  }
  void* begin = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), static_cast<off_t>(file_bytes_));
  if (begin == MAP_FAILED) {
    give_up(std::strerror(errno));
    return false;
  }
  file_bytes_ += bytes;
  segments_.push_back({static_cast<std::byte*>(begin), bytes});
  free_[pages].push_back(segments_.back().begin);
  return true;
}

bool FileMemory::make_file() {
  std::string name = folder_ + "/rumi-XXXXXX";
  file_ = FileDescriptor(mkostemp(name.data(), O_CLOEXEC));
  if (!file_) {
    give_up(std::strerror(errno));
    return false;
  }
  unlink(name.c_str());
  return true;
}

void FileMemory::give_up(const std::string& reason) {
  gave_up_ = true;
  log_warning("no room for keyframes in {}: {}; they stay in memory (another folder: TMPDIR)", folder_, reason);
}

bool FileMemory::is_in_file(const void* memory) const {
  return std::any_of(segments_.begin(), segments_.end(), [memory](const Segment& segment) {
    return memory >= segment.begin && memory < segment.begin + segment.bytes;
  });
}

}  // namespace rumi
