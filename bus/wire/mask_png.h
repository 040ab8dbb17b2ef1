// SPDX-License-Identifier: BSD-3-Clause
// Masks as PNG files, by libpng. OpenCV's codecs would load 110 libraries and 40 MB into every process that reads
// images.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

namespace rumi {

// Returns a PNG of one bit a pixel: white where `pixels` (8 bits, one channel) is not 0.
std::string mask_to_png(const cv::Mat& pixels);
// Returns CV_8UC1 of this size, the PNG's: 255 where any channel but the opacity is not 0. Empty if the PNG is damaged.
cv::Mat mask_from_png(std::string_view png, const cv::Size& size);

}  // namespace rumi
