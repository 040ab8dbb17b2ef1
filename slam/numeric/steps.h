// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "slam/numeric/median.h"

namespace rumi {

// Returns the differences from each value to the next.
template <class T>
std::vector<T> steps(const std::vector<T>& values) {
  std::vector<T> differences;
  for (std::size_t i = 1; i < values.size(); ++i) differences.push_back(values[i] - values[i - 1]);
  return differences;
}

// Returns the median of the positive steps; 0 if there are none.
template <class T>
T usual_step(const std::vector<T>& values) {
  std::vector<T> upwards = steps(values);
  std::erase_if(upwards, [](const T& step) { return !(step > 0); });
  return upwards.empty() ? T(0) : median(&upwards);
}

}  // namespace rumi
