// SPDX-License-Identifier: BSD-3-Clause
#include "formats/truth/text_fields.h"

#include <algorithm>
#include <cmath>

#include "base/text/number_text.h"

namespace rumi {

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
  const auto value = parse_number<double>(without_plus(text));
  return value && std::isfinite(*value) ? value : std::nullopt;
}

}  // namespace rumi
