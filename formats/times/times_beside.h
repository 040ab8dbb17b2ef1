// SPDX-License-Identifier: BSD-3-Clause
// Reads the times of images from a file beside them: KITTI's times.txt and timestamps.txt, TUM-mono's times.txt.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rumi {

struct TimesBeside {
  std::vector<std::string> times;  // one an image, in seconds or a unit to be found out; empty: none can be used
  std::string note;                // which file is used, or why one is not; may be empty
};

// Finds the file with times in the folder of the images, or the one above. A line is a time or a date, or begins with
// the image's number or name; `names` are those of all images, in the order in which they are played.
TimesBeside times_beside(const std::filesystem::path& folder, const std::vector<std::string>& names);
// Names a file with times that is not used, because the images have times in their names; empty if there is none.
std::string unused_times_beside(const std::filesystem::path& folder);

}  // namespace rumi
