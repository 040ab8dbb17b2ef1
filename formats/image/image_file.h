// SPDX-License-Identifier: BSD-3-Clause
// Loads image files of a recording.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "formats/image/grey_range.h"
#include "lcmtypes/rumi/image_t.hpp"

namespace rumi {

// Returns the range of brightness in some of the files, evenly chosen.
GreyRange sample_grey_range(const std::vector<std::filesystem::path>& files);

// Takes a JPEG as it is stored, and decodes other files: to RGB if they have colour and `colour` is true, else to grey.
// Asks for `range` if the pixels have 16 bits. Errors say why the image cannot be read; they do not name the file.
Result<image_t> load_image_file(const std::filesystem::path& file, bool colour,
                                const std::function<GreyRange()>& range);
// As load_image_file(), from the bytes of such a file.
Result<image_t> load_image_bytes(std::vector<uint8_t> bytes, bool colour, const std::function<GreyRange()>& range);
// As load_image_file(), for one page of a TIFF file, by its number in the file.
Result<image_t> load_tiff_page(const std::filesystem::path& file, int page, bool colour,
                               const std::function<GreyRange()>& range);
// Return pixels from which the range of a recording is found. Empty for a JPEG, which has 8 bits, and if the pixels
// cannot be read.
cv::Mat grey_pixels_of_page(const std::filesystem::path& file, int page);
cv::Mat grey_pixels_of_bytes(const std::vector<uint8_t>& bytes);

}  // namespace rumi
