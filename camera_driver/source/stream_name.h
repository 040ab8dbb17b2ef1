// SPDX-License-Identifier: BSD-3-Clause
// Computes the number of a stream from what it is made of. A recording has the same number wherever it lies and however
// often it is played; a camera as long as it is opened by the same name.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace rumi::camera_driver {

class StreamName {
 public:
  void add(std::span<const uint8_t> bytes);
  void add(std::string_view text);
  void add(int64_t number);
  // Returns the number, which is above 0.
  int64_t number() const;

 private:
  uint64_t hash_ = 0xcbf29ce484222325;  // FNV-1a, 64 bits
};

}  // namespace rumi::camera_driver
