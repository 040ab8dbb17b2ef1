// SPDX-License-Identifier: BSD-3-Clause
#include "base/text/nearest_word.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace rumi {
namespace {

size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = std::exchange(row[0], i);
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substitution = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, substitution}));
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& words) {
  constexpr size_t kMostLetters = 100;  // letters of `word` that are compared; the time grows with the length
  const std::string beginning = word.substr(0, kMostLetters);
  std::string nearest;
  size_t least = SIZE_MAX;
  for (const std::string& candidate : words)
    if (const size_t distance = edit_distance(candidate, beginning); distance < least)
      least = distance, nearest = candidate;
  return nearest;
}

std::string similar_word(const std::string& word, const std::vector<std::string>& words) {
  const std::string nearest = nearest_word(word, words);
  if (edit_distance(nearest, word) <= std::max<size_t>(1, word.size() / 3)) return nearest;
  const auto longer =
      std::find_if(words.begin(), words.end(), [&](const std::string& other) { return other.starts_with(word); });
  return word.empty() || longer == words.end() ? "" : *longer;
}

}  // namespace rumi
