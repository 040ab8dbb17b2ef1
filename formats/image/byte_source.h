// SPDX-License-Identifier: BSD-3-Clause
// Gives access to any bytes of a file, or of a decompressed piece of one.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/files/file_descriptor.h"

namespace rumi {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual int64_t size() const = 0;
  // Fills all of `out`. Returns false if there are not so many bytes, or they cannot be read.
  virtual bool read(int64_t at, std::span<uint8_t> out) = 0;
};

// A file, with the size that it had when it was opened. A buffer saves system calls when small reads follow each other.
class FileBytes : public ByteSource {
 public:
  explicit FileBytes(const std::string& file);
  int64_t size() const override { return size_; }
  bool read(int64_t at, std::span<uint8_t> out) override;

 private:
  FileDescriptor file_;
  int64_t size_ = 0;
  int64_t window_at_ = 0;
  std::vector<uint8_t> window_;
};

class MemoryBytes : public ByteSource {
 public:
  explicit MemoryBytes(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  int64_t size() const override { return static_cast<int64_t>(bytes_.size()); }
  bool read(int64_t at, std::span<uint8_t> out) override;

 private:
  std::span<const uint8_t> bytes_;
};

// Reads a little-endian number, as all bags have them.
template <class Number>
Number little_endian(std::span<const uint8_t> bytes) {
  uint64_t value = 0;
  for (size_t i = 0; i < sizeof(Number); ++i) value |= uint64_t{bytes[i]} << 8 * i;
  return static_cast<Number>(value);
}

}  // namespace rumi
