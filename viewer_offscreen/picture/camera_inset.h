// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

// Where the image of a camera goes in a room: as large as it fits, at the top, centred.
cv::Rect inset_area(const CameraView& view, const cv::Rect& room);
// The image with its keypoints; those that observe landmarks have `color`.
void draw_inset(cv::Mat& large, const CameraView& view, const cv::Rect& area, const cv::Vec3b& color);

}  // namespace rumi::viewer_offscreen
