// SPDX-License-Identifier: BSD-3-Clause
// A fuzz target: bytes from elsewhere, and the code of ours that they reach. Each is one file in targets/, which knows
// nothing of who runs it: libFuzzer (fuzzer.cpp), or a plain test (fuzz_test.cpp).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rumi::fuzz {

using Bytes = std::vector<uint8_t>;
using View = std::span<const uint8_t>;

// Changes the `size` bytes at `data`, of which there may be `max_size` then. Returns how many there are, 0: no change.
using Mutator = size_t (*)(uint8_t* data, size_t size, size_t max_size, unsigned seed);

struct Target {
  std::string name;
  // Must not crash, leak or hang, whatever the bytes are.
  void (*run)(View input) = nullptr;
  // Inputs that get far, made from the types: none is kept as bytes, which would be stale when a type changes.
  std::vector<Bytes> (*seeds)() = nullptr;
  Mutator mutate = nullptr;  // null: libFuzzer's own
};

// Those linked into this program.
const std::vector<Target>& targets();

// A global one in the target's file.
struct Registered {
  explicit Registered(Target target);
};

// A step of an input, a message, is over. While fuzzing, none may take more than a second of CPU time: time on the
// clock is other processes', too.
void end_step();
void limit_steps();  // from now on

inline Bytes to_bytes(const std::string& text) { return {text.begin(), text.end()}; }
inline std::string to_text(View bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace rumi::fuzz
