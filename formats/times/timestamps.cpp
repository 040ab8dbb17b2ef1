// SPDX-License-Identifier: BSD-3-Clause
#include "formats/times/timestamps.h"

#include <fmt/format.h>

#include <array>

#include "base/text/number_text.h"

namespace rumi {
namespace {

constexpr int64_t kMaxUs = int64_t{1} << 53;  // no time in a message may be this large: the year 2255

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Holds the parts of digits[.digits][e[+-]digits]: value = digits * 10^exponent.
struct Decimal {
  std::string digits;
  int exponent = 0;
};

std::optional<Decimal> parse_decimal(std::string_view text) {
  Decimal decimal;
  size_t at = 0;
  if (at < text.size() && text[at] == '+') ++at;
  bool after_point = false;
  for (; at < text.size() && (is_digit(text[at]) || (text[at] == '.' && !after_point)); ++at) {
    if (text[at] == '.') {
      after_point = true;
    } else {
      decimal.digits += text[at];
      decimal.exponent -= after_point ? 1 : 0;
    }
  }
  if (decimal.digits.empty() || decimal.digits.size() > 60) return std::nullopt;
  if (at == text.size()) return decimal;
  if (text[at] != 'e' && text[at] != 'E') return std::nullopt;
  ++at;
  if (at < text.size() && text[at] == '+') ++at;
  const auto power = parse_number<int>(text.substr(at));
  if (!power || *power < -100 || *power > 100) return std::nullopt;
  decimal.exponent += *power;
  return decimal;
}

// Returns digits * 10^exponent as an integer, rounded half up; nullopt from kMaxUs on.
std::optional<int64_t> round_decimal(const Decimal& decimal) {
  const int kept = static_cast<int>(decimal.digits.size()) + decimal.exponent;  // digits before the point
  int64_t value = 0;
  for (int i = 0; i < kept; ++i) {
    const bool given = i < static_cast<int>(decimal.digits.size());
    value = 10 * value + (given ? decimal.digits[static_cast<size_t>(i)] - '0' : 0);
    if (value >= kMaxUs) return std::nullopt;
  }
  const bool up =
      kept >= 0 && kept < static_cast<int>(decimal.digits.size()) && decimal.digits[static_cast<size_t>(kept)] >= '5';
  return value + (up ? 1 : 0);
}

}  // namespace

std::optional<int64_t> parse_time_us(std::string_view text, TimeUnit unit) {
  static constexpr std::array kExponents = {6, 3, 0, -3};
  std::optional<Decimal> decimal = parse_decimal(text);
  if (!decimal) return std::nullopt;
  decimal->exponent += kExponents.at(static_cast<size_t>(unit));
  return round_decimal(*decimal);
}

std::string format_seconds(int64_t utime_us) {
  return fmt::format("{}.{:06}", utime_us / 1'000'000, utime_us % 1'000'000);
}

}  // namespace rumi
