// SPDX-License-Identifier: BSD-3-Clause
// The size at which images are worked on. front_tracker and ruminator must use the same one, so that an image has
// the same keypoints in both.
#pragma once

#include <opencv2/core/mat.hpp>

#include "base/result.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "slam/geometry/camera.h"

namespace rumi {

inline constexpr int kDefaultMaxImageSide = 960;  // pixels; larger images take more time in proportion, and add little

// Returns the camera with its images scaled down until no side is longer than `max_side` pixels (0: unchanged).
Camera working_camera(const Camera& camera, int max_side);

// Decodes a message with an image of `camera` to 8-bit grey of `working`'s size. An Error if the image has another size
// than `camera`, or if decode_grey() gives one.
Result<cv::Mat> decode_working_image(const image_t& image, const Camera& camera, const Camera& working);

}  // namespace rumi
