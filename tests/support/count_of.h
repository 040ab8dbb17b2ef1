// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rumi::testing {

// Returns how often a word occurs in a text.
inline size_t count_of(const std::string& text, const std::string& word) {
  size_t count = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

}  // namespace rumi::testing
