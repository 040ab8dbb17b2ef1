// SPDX-License-Identifier: BSD-3-Clause
// Brings an image into the form in which it is published, see CameraOptions::encoding.
#pragma once

#include <opencv2/core/mat.hpp>

#include "base/result.h"
#include "camera_driver/source/camera_options.h"
#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::camera_driver {

// An Error if the image has to be decoded for the new form, and is damaged.
Result<image_t> encode_as(image_t image, const CameraOptions& options);
// Encodes 8-bit pixels, grey or BGR. With "auto" they keep their channels.
image_t encode_pixels(int64_t utime_us, const cv::Mat& pixels, const CameraOptions& options);

}  // namespace rumi::camera_driver
