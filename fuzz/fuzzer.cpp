// SPDX-License-Identifier: BSD-3-Clause
// The two functions that libFuzzer calls. They run the one target that is linked with them.
#include "fuzz/target.h"

using rumi::fuzz::Target;

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

namespace {

const Target& the_target() { return rumi::fuzz::targets().front(); }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // The first run makes the target's static data, which must not count as a step.
  static const bool warm = (the_target().run({}), true);
  if (!warm) return -1;
  rumi::fuzz::limit_steps();
  the_target().run({data, size});
  rumi::fuzz::end_step();
  return 0;
}

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned seed) {
  const size_t mutated = the_target().mutate ? the_target().mutate(data, size, max_size, seed) : 0;
  return mutated > 0 ? mutated : LLVMFuzzerMutate(data, size, max_size);
}
