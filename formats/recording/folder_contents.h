// SPDX-License-Identifier: BSD-3-Clause
// Looks at the files in a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rumi {

// True if the name ends like that of an image of a kind that is read; hidden files are no images.
bool is_image_name(const std::filesystem::path& file);
// Returns the names of files in a folder that are pictures, by their endings, but of a kind that is not read.
std::vector<std::string> pictures_not_read(const std::filesystem::path& folder);
// Counts the files of a folder that are not taken for images: "12 .gif, 3 without an ending"; empty if there are none.
std::string other_files(const std::filesystem::path& folder);
// Returns the videos, lcm logs (walk.lcm.00, too) and bags in a folder, in the order of their numbers.
std::vector<std::filesystem::path> recording_files(const std::filesystem::path& folder);
// Returns the first names of recording_files(): "a.mp4, b.lcm"; empty if there are none.
std::string recordings_in(const std::filesystem::path& folder);

}  // namespace rumi
