// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/text_fields.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace rumi::tool {

std::vector<std::string> split(const std::string& line, const char* separators) {
  std::vector<std::string> fields;
  for (size_t begin = line.find_first_not_of(separators); begin != std::string::npos;) {
    const size_t end = std::min(line.find_first_of(separators, begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(separators, end);
  }
  return fields;
}

std::optional<double> to_number(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [stop, error] = std::from_chars(begin, end, value);
  return error == std::errc() && stop == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace rumi::tool
