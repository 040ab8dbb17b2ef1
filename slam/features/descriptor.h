// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace rumi {

// 256-bit binary descriptor (ORB).
using Descriptor = std::array<uint64_t, 4>;
static_assert(sizeof(Descriptor) == 32);

inline int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

}  // namespace rumi
