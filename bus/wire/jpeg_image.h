// SPDX-License-Identifier: BSD-3-Clause
// Stands apart from image_codec.h, so that programs that only read images do not load OpenCV's codecs: 110 libraries,
// 40 MB, 60 ms.
#pragma once

#include <opencv2/core/mat.hpp>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi {

// `image`: 8 bits, grey or BGR.
image_t make_jpeg_image(int64_t utime_us, const cv::Mat& image, int quality = 90);

}  // namespace rumi
