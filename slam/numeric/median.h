// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace rumi {

// Returns the middle value, or the upper of the two middle ones, so that it is always one of the values (a mean of
// whole numbers would have to be rounded). Reorders the values. Precondition: at least one value, none of them NaN.
template <class T>
T median(std::vector<T>* values) {
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

// Standard deviation / median absolute deviation of a normal distribution.
inline constexpr double kSigmaFromMad = 1.4826;

// A median and its standard error.
struct RobustMean {
  double value = 0, sigma = 0;
};

// Returns the median and its standard error. The error follows from the median absolute deviation as if `independent`
// of the values were independent. Leaves the absolute deviations in *values. Precondition: at least one value, none
// NaN.
inline RobustMean robust_mean(std::vector<double>* values, double independent) {
  constexpr double kMedianErrorOverMeans = 1.2533;  // sqrt(pi / 2): standard error of the median / that of the mean,
                                                    // for a normal distribution
  const double middle = median(values);
  for (double& value : *values) value = std::abs(value - middle);
  return {middle, kMedianErrorOverMeans * kSigmaFromMad * median(values) / std::sqrt(independent)};
}

}  // namespace rumi
