// SPDX-License-Identifier: BSD-3-Clause
// Bytes that are read here and there: of a file, or of a piece of one that was decompressed.
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
  // Fills all of `out`; false if there are not so many bytes, or they cannot be read.
  virtual bool read(int64_t at, std::span<uint8_t> out) = 0;
};

// A file, as long as it was when it was opened. Small reads that follow each other cost no system call each.
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

// Little endian, as all bags are.
template <class Number>
Number little_endian(std::span<const uint8_t> bytes) {
  uint64_t value = 0;
  for (size_t i = 0; i < sizeof(Number); ++i) value |= uint64_t{bytes[i]} << 8 * i;
  return static_cast<Number>(value);
}

}  // namespace rumi
