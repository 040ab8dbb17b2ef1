// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

// Returns the rectangle for a camera's image within `room`: as large as possible, at the top, centred.
cv::Rect inset_area(const CameraView& view, const cv::Rect& room);
// Draws the image with its keypoints. Those that observe landmarks have the colour `color`.
void draw_inset(cv::Mat& large, const CameraView& view, const cv::Rect& area, const cv::Vec3b& color);

}  // namespace rumi::viewer_offscreen
