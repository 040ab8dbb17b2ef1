// SPDX-License-Identifier: BSD-3-Clause
// Functions that the mutators of scripts, logs and messages share.
#pragma once

#include <random>

#include "fuzz/target.h"

namespace rumi::fuzz {

using Random = std::minstd_rand;

inline constexpr size_t kFingerprintBytes = 8;  // at the beginning of every LCM message

inline size_t below(Random& random, size_t end) { return end == 0 ? 0 : random() % end; }

// Changes the bytes from `fixed` on (rarely those before it, too): writes a number that often breaks code, or lets
// libFuzzer mutate them.
void mutate_after(Random& random, size_t fixed, Bytes* bytes);

// A Mutator for a single message. It rarely changes the fingerprint.
size_t mutate_message(uint8_t* data, size_t size, size_t max_size, unsigned seed);

}  // namespace rumi::fuzz
