// SPDX-License-Identifier: BSD-3-Clause
// The sampling picture, after Fig. 6 of the paper: above, images as they came; in the middle a strip with a cell per
// frame that says what became of it; below, the samples.
#pragma once

#include <opencv2/core/mat.hpp>

#include "rumi/windows/window_scene.h"

namespace rumi::tool {

// BGR.
cv::Mat draw_window(const WindowScene& scene);

}  // namespace rumi::tool
