// SPDX-License-Identifier: BSD-3-Clause
// What `rumi --version` says, for reports of what went wrong.
#pragma once

#include <string>

namespace rumi::tool {

// "rumi 0.2.0", the commit and the libraries that are loaded, a line each.
std::string about();

}  // namespace rumi::tool
