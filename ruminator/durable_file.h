// SPDX-License-Identifier: BSD-3-Clause
// Files that appear whole or not at all and survive a power cut once they are there.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace rumi {

// A name beside `file` that no other process writes to.
std::string temporary_name(const std::string& file);
// Brings the finished temporary file to the disk and gives it its name. Returns what went wrong (then the temporary
// file is gone), or an empty string.
std::string commit_file(const std::string& temporary, const std::string& file);
// Both steps at once.
std::string write_file_durably(const std::string& file, std::span<const uint8_t> bytes);

}  // namespace rumi
