// SPDX-License-Identifier: BSD-3-Clause
// Helps to find out the kind of a file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace rumi {

// Returns the first bytes of the file, at most `bytes`; empty if it cannot be read.
std::string beginning_of(const std::filesystem::path& file, size_t bytes);
// Returns the extension in lower case: ".jpg" for "A.JPG".
std::string lower_extension(const std::filesystem::path& file);

}  // namespace rumi
