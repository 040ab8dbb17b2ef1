// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace rumi::tool {

// The image (BGR), with what the mask leaves out in red; without an image the mask alone, or of no PNG nothing.
cv::Mat draw_mask(const std::string& png, const cv::Mat& image);

}  // namespace rumi::tool
