// SPDX-License-Identifier: BSD-3-Clause
// What a run of Rumi wrote, given where a recording is expected.
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// What it is and what to give instead, or an empty string. A folder that has images of its own is a recording, even
// if a run wrote into it.
std::string advice_on_own_output(const std::filesystem::path& path);

}  // namespace rumi
