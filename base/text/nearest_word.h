// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace rumi {

// Returns the word with the smallest edit distance to `word`; empty if there are no words.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);
// As nearest_word(), but returns an empty string if no word is similar: a few letters off, or beginning with `word`.
std::string similar_word(const std::string& word, const std::vector<std::string>& words);

}  // namespace rumi
