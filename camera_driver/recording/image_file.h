// SPDX-License-Identifier: BSD-3-Clause
// Image files of a recording.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::camera_driver {

// Pixels of 16 bits become 8: `low` and less become 0, `high` and more 255, linearly between.
struct GreyRange {
  int low = 0, high = 65535;  // low < high
};

// "LOW:HIGH"; nothing for anything else.
std::optional<GreyRange> parse_grey_range(const std::string& text);
// Of all pixels of some of the files, evenly chosen, but for the darkest and the brightest thousandth. All of 16 bits
// if none of them can be read.
GreyRange sample_grey_range(const std::vector<std::filesystem::path>& files);

// JPEG as stored, other files decoded: RGB if they have colour and `colour` is wanted, else grey. `range` is asked when
// pixels have 16 bits. Nothing, and why in *error, if the file cannot be read.
std::optional<image_t> load_image_file(const std::filesystem::path& file, bool colour,
                                       const std::function<GreyRange()>& range, std::string* error);

}  // namespace rumi::camera_driver
