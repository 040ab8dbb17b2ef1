// SPDX-License-Identifier: BSD-3-Clause
// For callers that cannot go on without the value: a process that cannot start, a broken invariant, a test's fixture.
#pragma once

#include <stdexcept>
#include <type_traits>
#include <utility>

#include "base/result.h"

namespace rumi {

// Returns the value; throws std::runtime_error with the Error's text.
template <class T>
T or_throw(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().text());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

}  // namespace rumi
