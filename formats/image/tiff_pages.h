// SPDX-License-Identifier: BSD-3-Clause
// Finds the pages of a TIFF file: microscopes and machine vision store a recording as the pages of one file.
#pragma once

#include <filesystem>
#include <vector>

namespace rumi {

// Returns the numbers, from 0, of the pages that have the size of the first one: smaller copies do not count. Empty if
// the file is no TIFF file; if it is broken, the pages before the damage.
std::vector<int> pages_of_tiff(const std::filesystem::path& file);

}  // namespace rumi
