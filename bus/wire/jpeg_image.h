// SPDX-License-Identifier: BSD-3-Clause
// By libjpeg itself: OpenCV's codecs would load 110 libraries and 40 MB into every process that reads images.
#pragma once

#include <opencv2/core/mat.hpp>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi {

// Makes a message with `image` (8 bits, grey or BGR) as a JPEG of this quality (0 to 100).
image_t make_jpeg_image(int64_t utime_us, const cv::Mat& image, int quality = 90);

}  // namespace rumi
