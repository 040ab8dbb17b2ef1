// SPDX-License-Identifier: BSD-3-Clause
// Eigen's assertions throw, in every build type: a process that holds a map must not end because of one matrix.
// cmake/RumiDefaults.cmake includes this file before everything else, so that all files have the same Eigen.
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
