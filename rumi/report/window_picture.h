// SPDX-License-Identifier: BSD-3-Clause
// Draws how a window was sampled, after Fig. 6 of the paper. Above are some images; in the middle a strip with a cell
// per frame, coloured by its tracking state; below the samples.
#pragma once

#include <opencv2/core/mat.hpp>

#include "rumi/windows/window_scene.h"

namespace rumi::tool {

// Returns BGR.
cv::Mat draw_window(const WindowScene& scene);

}  // namespace rumi::tool
