// SPDX-License-Identifier: BSD-3-Clause
// The number of a stream, by what it is made of: a recording has the same one wherever it lies and however often it is
// played, a camera as long as it hangs at the same place.
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
  // The number is above 0.
  int64_t number() const;

 private:
  uint64_t hash_ = 0xcbf29ce484222325;  // FNV-1a, 64 bits
};

}  // namespace rumi::camera_driver
