// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace rumi::tool {

// Draws the masked parts in red over the image (BGR). Returns the mask alone if there is no image, and an empty Mat if
// `png` is no PNG.
cv::Mat draw_mask(const std::string& png, const cv::Mat& image);

}  // namespace rumi::tool
