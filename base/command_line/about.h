// SPDX-License-Identifier: BSD-3-Clause
// The text of --version. It is not in this folder's library, because each commit relinks every program that calls it.
#pragma once

#include <string>

namespace rumi {

// The commit of the sources, "1a8568d" or "1a8568d+changes"; cmake/WriteCommit.cmake writes it.
extern const char* const kCommit;

// "camera_driver 0.2.0" and the commit, a line each.
std::string about(const std::string& program);

}  // namespace rumi
