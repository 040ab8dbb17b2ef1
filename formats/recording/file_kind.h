// SPDX-License-Identifier: BSD-3-Clause
// What tells of which kind a file is.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace rumi {

// Its first bytes, at most so many; empty if it cannot be read.
std::string beginning_of(const std::filesystem::path& file, size_t bytes);
// ".jpg", also of "A.JPG".
std::string lower_extension(const std::filesystem::path& file);

}  // namespace rumi
