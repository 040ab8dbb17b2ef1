// SPDX-License-Identifier: BSD-3-Clause
// Plain mutations mostly break an LCM fingerprint or the length of an event, and the input is refused at once. These
// mutations keep both.
#include <algorithm>

#include "fuzz/mutation.h"
#include "fuzz/script.h"

namespace rumi::fuzz {
namespace {

size_t fixed_bytes(const Event& event) {
  if (event.kind < Event::kFirstOther) return kFingerprintBytes;
  return event.kind == Event::kPayload ? kFingerprintBytes + 2 : 0;
}

const Script& good_events() {
  static const Script all = [] {
    Script events;
    for (const Bytes& seed : targets().front().seeds())
      for (Event& event : parse_script(seed)) events.push_back(std::move(event));
    return events;
  }();
  return all;
}

void mutate(Random& random, Script* script) {
  const size_t at = below(random, script->size());
  const auto place = script->begin() + static_cast<ptrdiff_t>(at);
  const size_t choice = script->empty() ? 8 : below(random, 12);
  if (choice < 7) {
    mutate_after(random, fixed_bytes(*place), &place->bytes);
  } else if (choice < 9) {
    const Script& good = good_events();
    if (!good.empty()) script->insert(place, good[below(random, good.size())]);
  } else if (choice == 9) {
    script->erase(place);
  } else if (choice == 10) {
    const Event copy = *place;
    script->insert(place, copy);
  } else {
    std::swap(*place, (*script)[below(random, script->size())]);
  }
}

}  // namespace

size_t mutate_script(uint8_t* data, size_t size, size_t max_size, unsigned seed) {
  Random random(seed);
  if (below(random, 24) == 0) return 0;
  Script script = parse_script({data, size});
  for (size_t i = 0; i <= below(random, 3); ++i) mutate(random, &script);
  const Bytes bytes = to_bytes(script);
  if (bytes.empty() || bytes.size() > max_size) return 0;
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}

}  // namespace rumi::fuzz
