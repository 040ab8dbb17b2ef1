// SPDX-License-Identifier: BSD-3-Clause
// The text of --version. It is not in this folder's library: each commit would relink every program that uses the
// library.
#pragma once

#include <string>

namespace rumi {

// The commit that was built, "1a8568d" or "1a8568d+changes"; written by cmake/WriteCommit.cmake.
extern const char* const kCommit;

// Returns "camera_driver 0.2.0" and the commit, on a line each.
std::string about(const std::string& program);

}  // namespace rumi
