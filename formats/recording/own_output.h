// SPDX-License-Identifier: BSD-3-Clause
// Recognizes the outputs of Rumi's runs where a recording is expected.
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// Says what the path is and what to give instead; empty if it is no output. A folder with images of its own is a
// recording, even if a run wrote into it.
std::string advice_on_own_output(const std::filesystem::path& path);

}  // namespace rumi
