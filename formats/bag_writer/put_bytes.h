// SPDX-License-Identifier: BSD-3-Clause
// Appends numbers and texts as bags store them, little endian.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace rumi {

template <class Number>
void put(Number value, std::string* out) {
  const auto bits = static_cast<std::make_unsigned_t<Number>>(value);
  for (size_t i = 0; i < sizeof(Number); ++i) *out += static_cast<char>(bits >> 8 * i);
}

// Puts the text's length before the text.
inline void put_text(std::string_view text, std::string* out) {
  put(static_cast<uint32_t>(text.size()), out);
  *out += text;
}

}  // namespace rumi
