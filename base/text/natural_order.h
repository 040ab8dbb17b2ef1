// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rumi {

// True if a comes before b when runs of digits are compared as numbers.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace rumi
