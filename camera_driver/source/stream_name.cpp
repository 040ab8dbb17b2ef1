// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/source/stream_name.h"

#include <algorithm>

namespace rumi::camera_driver {
namespace {

constexpr uint64_t kPrime = 0x100000001b3;
constexpr uint64_t kPositive = (uint64_t{1} << 63) - 1;

}  // namespace

void StreamName::add(std::span<const uint8_t> bytes) {
  for (const uint8_t byte : bytes) hash_ = (hash_ ^ byte) * kPrime;
}

void StreamName::add(std::string_view text) {
  add(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

void StreamName::add(int64_t number) {
  for (int shift = 0; shift < 64; shift += 8)
    hash_ = (hash_ ^ (static_cast<uint64_t>(number) >> shift & 0xff)) * kPrime;
}

int64_t StreamName::number() const { return static_cast<int64_t>(std::max<uint64_t>(hash_ & kPositive, 1)); }

}  // namespace rumi::camera_driver
