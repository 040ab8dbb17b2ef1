// SPDX-License-Identifier: BSD-3-Clause
// Recognizes the outputs of Rumi's runs where a recording is expected.
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// Says what the path is and what to give instead; empty if it is neither an output folder nor a database. A folder that
// holds any other file counts as no output: it may be a recording into which a run wrote.
std::string advice_on_own_output(const std::filesystem::path& path);

}  // namespace rumi
