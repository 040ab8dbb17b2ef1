// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace rumi {

// Returns nullopt unless the whole text is a number: "12abc", "", "+1" and " 1" are not. "nan" and "inf" are doubles.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

// Removes the plus sign of "+1", which parse_number() does not accept and other programs write.
inline std::string_view without_plus(std::string_view text) { return text.starts_with('+') ? text.substr(1) : text; }

}  // namespace rumi
