// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/byte_source.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace rumi {
namespace {

constexpr size_t kWindowBytes = 16 << 10;

// Returns how many bytes were read.
size_t read_at(int fd, int64_t at, std::span<uint8_t> out) {
  size_t done = 0;
  while (done < out.size()) {
    const ssize_t got = pread(fd, out.data() + done, out.size() - done, at + static_cast<int64_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += static_cast<size_t>(got);
  }
  return done;
}

}  // namespace

FileBytes::FileBytes(const std::string& file) : file_(open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
  const off_t end = lseek(file_.get(), 0, SEEK_END);
  size_ = std::max<int64_t>(0, end);
}

bool FileBytes::read(int64_t at, std::span<uint8_t> out) {
  const auto count = static_cast<int64_t>(out.size());
  if (at < 0 || at > size_ || count > size_ - at) return false;
  if (out.size() >= kWindowBytes) return read_at(file_.get(), at, out) == out.size();
  const auto end = window_at_ + static_cast<int64_t>(window_.size());
  if (at < window_at_ || at + count > end) {
    window_.resize(kWindowBytes);
    window_.resize(read_at(file_.get(), at, window_));
    window_at_ = at;
    if (window_.size() < out.size()) return false;
  }
  std::copy_n(window_.begin() + (at - window_at_), count, out.begin());
  return true;
}

bool MemoryBytes::read(int64_t at, std::span<uint8_t> out) {
  if (at < 0 || at > size() || static_cast<int64_t>(out.size()) > size() - at) return false;
  std::copy_n(bytes_.begin() + at, out.size(), out.begin());
  return true;
}

}  // namespace rumi
