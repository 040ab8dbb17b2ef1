// SPDX-License-Identifier: BSD-3-Clause
// The fields of a line of text.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rumi {

// Splits at any of the separators; there are no empty fields.
std::vector<std::string> split(const std::string& line, const char* separators);
// A finite number, and nothing else.
std::optional<double> to_number(const std::string& text);
// Larger ones are no positions, in whatever unit: of the globe in millimetres there are some of 1e10.
inline constexpr double kLargestPosition = 1e11;

}  // namespace rumi
