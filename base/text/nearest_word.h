// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace rumi {

// The word whose spelling is nearest to `word`; empty if there are no words.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);
// As above, but nothing if no word has much in common with it.
std::string similar_word(const std::string& word, const std::vector<std::string>& words);

}  // namespace rumi
