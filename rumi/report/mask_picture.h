// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace rumi::tool {

// The image (BGR) with the masked parts in red; without an image the mask alone; empty if the mask is no PNG.
cv::Mat draw_mask(const std::string& png, const cv::Mat& image);

}  // namespace rumi::tool
