// SPDX-License-Identifier: BSD-3-Clause
// Eigen's failed assertions throw in every build type, so that one wrong matrix does not end a process that holds a
// map. cmake/RumiDefaults.cmake includes this file before everything else in every source, so that all see the same
// Eigen.
#pragma once

#include <stdexcept>
#include <string>

namespace rumi {

[[noreturn, gnu::cold, gnu::noinline]] inline void throw_eigen_assertion(const char* expression, const char* file,
                                                                         int line) {
  throw std::logic_error(std::string(file) + ":" + std::to_string(line) + ": Eigen asserts " + expression);
}

}  // namespace rumi

#define eigen_assert(x) \
  (static_cast<bool>(x) ? static_cast<void>(0) : ::rumi::throw_eigen_assertion(#x, __FILE__, __LINE__))
