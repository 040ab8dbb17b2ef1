// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace rumi {

// The middle value; of an even number the upper of the two in the middle, so that it is always one of the values (no
// mean, which whole numbers would have to round). Reorders them. Precondition: at least one value, none of them NaN.
template <class T>
T median(std::vector<T>* values) {
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

}  // namespace rumi
