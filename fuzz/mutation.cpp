// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/mutation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// Defined by libFuzzer. fuzz_test is linked without it and never calls a mutator, so the symbol is weak.
extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size) __attribute__((weak));

namespace rumi::fuzz {
namespace {

constexpr size_t kRoom = 64;  // bytes by which one mutation may lengthen the input, at most

template <class T>
void put_big_endian(T value, uint8_t* at) {
  const auto* bytes = reinterpret_cast<const uint8_t*>(&value);
  std::reverse_copy(bytes, bytes + sizeof(T), at);
}

// Overwrites bytes at a random place from `begin` on with a number that often breaks code, in big endian as LCM has it.
// Does nothing if fewer than 8 bytes follow `begin`.
void put_number(Random& random, Bytes* bytes, size_t begin) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::array<double, 12> kReals = {0,      -0.0, 1,    -1,   1e-300,    1e300,
                                             -1e300, 1e9,  1e19, kNaN, kInfinity, -kInfinity};
  constexpr std::array<int64_t, 14> kWhole = {
      0, 1, 2, -1, -2, 127, 255, 1 << 16, INT32_MAX, INT32_MIN, INT64_MAX, INT64_MIN, int64_t{1} << 53, 1'000'000};
  if (bytes->size() < begin + 8) return;
  uint8_t* at = bytes->data() + begin + below(random, bytes->size() - begin - 7);
  const double real = kReals[below(random, kReals.size())];
  const int64_t whole = kWhole[below(random, kWhole.size())];
  switch (below(random, 5)) {
    case 0:
      return put_big_endian(real, at);
    case 1:
      return put_big_endian(static_cast<float>(std::isinf(real) ? real : std::clamp(real, -3e38, 3e38)), at);
    case 2:
      return put_big_endian(whole, at);
    case 3:
      return put_big_endian(static_cast<int32_t>(whole), at);
    default:
      *at = static_cast<uint8_t>(whole);
  }
}

}  // namespace

void mutate_after(Random& random, size_t fixed, Bytes* bytes) {
  fixed = std::min(fixed, bytes->size());
  if (below(random, 2) == 0) return put_number(random, bytes, fixed);
  const size_t from = below(random, 32) == 0 ? 0 : fixed, size = bytes->size() - from;
  bytes->resize(bytes->size() + kRoom);
  bytes->resize(from + LLVMFuzzerMutate(bytes->data() + from, size, size + kRoom));
}

size_t mutate_message(uint8_t* data, size_t size, size_t max_size, unsigned seed) {
  Random random(seed);
  Bytes bytes(data, data + size);
  mutate_after(random, kFingerprintBytes, &bytes);
  if (bytes.empty() || bytes.size() > max_size) return 0;
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}

}  // namespace rumi::fuzz
