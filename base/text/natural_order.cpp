// SPDX-License-Identifier: BSD-3-Clause
#include "base/text/natural_order.h"

namespace rumi {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto number = [](const std::string& text, size_t* at) {
      size_t end = *at;
      while (end < text.size() && is_digit(text[end])) ++end;
      size_t begin = *at;
      while (begin + 1 < end && text[begin] == '0') ++begin;
      *at = end;
      return text.substr(begin, end - begin);
    };
    const std::string x = number(a, &i), y = number(b, &j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // equal as numbers but not as text, such as "01" and "1"
}

}  // namespace rumi
