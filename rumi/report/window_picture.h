// SPDX-License-Identifier: BSD-3-Clause
// The sampling picture, after Fig. 6 of the paper. Above: some images; in the middle: a strip with a cell per frame,
// coloured by its tracking; below: the samples.
#pragma once

#include <opencv2/core/mat.hpp>

#include "rumi/windows/window_scene.h"

namespace rumi::tool {

// BGR.
cv::Mat draw_window(const WindowScene& scene);

}  // namespace rumi::tool
