// SPDX-License-Identifier: BSD-3-Clause
// Splits a line of text into fields, and reads numbers.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rumi {

// Splits at any of the separators; there are no empty fields.
std::vector<std::string> split(const std::string& line, const char* separators);
// Reads a finite number; nullopt for any other text.
std::optional<double> to_number(const std::string& text);
// A larger number is no coordinate in any unit: even coordinates on the globe, in millimetres, reach only about 1e10.
inline constexpr double kLargestPosition = 1e11;

}  // namespace rumi
