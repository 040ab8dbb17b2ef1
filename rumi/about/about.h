// SPDX-License-Identifier: BSD-3-Clause
// The text of `rumi --version`, which a problem report needs.
#pragma once

#include <string>

namespace rumi::tool {

// Returns "rumi 0.2.0", the commit, and the libraries that are loaded, one line each.
std::string about();

}  // namespace rumi::tool
