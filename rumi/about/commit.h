// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi::tool {

// That of the sources, "1a8568d" or "1a8568d+changes"; written by cmake/WriteCommit.cmake.
extern const char* const kCommit;

}  // namespace rumi::tool
