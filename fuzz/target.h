// SPDX-License-Identifier: BSD-3-Clause
// A fuzz target: the code that bytes from outside reach. Each is one file in targets/ and does not depend on what runs
// it: libFuzzer (fuzzer.cpp) or a plain test (fuzz_test.cpp).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rumi::fuzz {

using Bytes = std::vector<uint8_t>;
using View = std::span<const uint8_t>;

// Mutates the `size` bytes at `data` in place; the result may have up to `max_size` bytes. Returns its size, or 0 if
// nothing was changed.
using Mutator = size_t (*)(uint8_t* data, size_t size, size_t max_size, unsigned seed);

struct Target {
  std::string name;
  // Must not crash, leak or hang, whatever the bytes are.
  void (*run)(View input) = nullptr;
  // Returns inputs that reach deep into the code. They are made from the types at each start, as stored bytes would be
  // outdated when a type changes.
  std::vector<Bytes> (*seeds)() = nullptr;
  Mutator mutate = nullptr;  // null: libFuzzer's own mutator is used
};

// The targets that are linked into this program.
const std::vector<Target>& targets();

// Adds a target to targets(). The target's file has a global one.
struct Registered {
  explicit Registered(Target target);
};

// Ends a step of an input, for example a message. After limit_steps() it aborts the process if the step took more than
// a second of CPU time. Wall time would depend on the other processes.
void end_step();
void limit_steps();  // limits this step, which begins now, and all later ones

inline Bytes to_bytes(const std::string& text) { return {text.begin(), text.end()}; }
inline std::string to_text(View bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace rumi::fuzz
