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

#include "formats/image/grey_range.h"
#include "lcmtypes/rumi/image_t.hpp"

namespace rumi {

// Of some of the files, evenly chosen.
GreyRange sample_grey_range(const std::vector<std::filesystem::path>& files);

// JPEG as stored, other files decoded: RGB if they have colour and `colour` is wanted, else grey. `range` is asked when
// pixels have 16 bits. Nothing, and why in *error, if the file cannot be read.
std::optional<image_t> load_image_file(const std::filesystem::path& file, bool colour,
                                       const std::function<GreyRange()>& range, std::string* error);
// The same, of the bytes of such a file.
std::optional<image_t> load_image_bytes(std::vector<uint8_t> bytes, bool colour,
                                        const std::function<GreyRange()>& range, std::string* error);
// The same, of one page of a TIFF file, by its number in it.
std::optional<image_t> load_tiff_page(const std::filesystem::path& file, int page, bool colour,
                                      const std::function<GreyRange()>& range, std::string* error);
cv::Mat grey_pixels_of_page(const std::filesystem::path& file, int page);
// To find the range of a recording: empty for a JPEG, which has 8 bits, and for what cannot be read.
cv::Mat grey_pixels_of_bytes(const std::vector<uint8_t>& bytes);

}  // namespace rumi
