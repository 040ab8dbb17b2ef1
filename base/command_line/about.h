// SPDX-License-Identifier: BSD-3-Clause
// What --version says. Not in the library of the folder: with every commit, whoever calls this is linked anew.
#pragma once

#include <string>

namespace rumi {

// That of the sources, "1a8568d" or "1a8568d+changes"; written by cmake/WriteCommit.cmake.
extern const char* const kCommit;

// "camera_driver 0.2.0" and the commit, a line each.
std::string about(const std::string& program);

}  // namespace rumi
