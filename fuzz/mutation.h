// SPDX-License-Identifier: BSD-3-Clause
// Shared by the mutators.
#pragma once

#include <random>

#include "fuzz/target.h"

namespace rumi::fuzz {

using Random = std::minstd_rand;

inline constexpr size_t kFingerprintBytes = 8;  // of a message

inline size_t below(Random& random, size_t end) { return end == 0 ? 0 : random() % end; }

// Changes the bytes from `fixed` on (rarely those before it, too): a number at which code breaks, or what libFuzzer
// likes.
void mutate_after(Random& random, size_t fixed, Bytes* bytes);

// A Mutator for a single message: its fingerprint stays.
size_t mutate_message(uint8_t* data, size_t size, size_t max_size, unsigned seed);

}  // namespace rumi::fuzz
