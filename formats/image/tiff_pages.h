// SPDX-License-Identifier: BSD-3-Clause
// Microscopes and machine vision store a recording as the pages of one TIFF file.
#pragma once

#include <filesystem>
#include <vector>

namespace rumi {

// The pages of a TIFF file that have the size of its first one, by their numbers in the file: smaller copies are none.
// Empty for what is no TIFF file, or a broken one.
std::vector<int> pages_of_tiff(const std::filesystem::path& file);

}  // namespace rumi
