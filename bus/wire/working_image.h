// SPDX-License-Identifier: BSD-3-Clause
// The size at which images are worked on. Front and back must use the same, for the same image to have the same
// keypoints in both.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "lcmtypes/rumi/image_t.hpp"
#include "slam/geometry/camera.h"

namespace rumi {

inline constexpr int kDefaultMaxImageSide = 960;  // pixels; a larger image costs in proportion and tells little more

// The camera as if it took images of which neither side is longer than `max_side` pixels (0: as long as they are).
Camera working_camera(const Camera& camera, int max_side);

// 8-bit grey image of `working`'s size, from a message with an image of `camera`. On failure an empty Mat and in *error
// what is wrong (field, value), as decode_grey().
cv::Mat decode_working_image(const image_t& image, const Camera& camera, const Camera& working, std::string* error);

}  // namespace rumi
