// SPDX-License-Identifier: BSD-3-Clause
// Draws the views of the board that `rumi calibrate` has taken: where in the image they are, and how they are tilted.
#pragma once

#include <opencv2/core/mat.hpp>

#include "rumi/calibration/view_collector.h"

namespace rumi::tool {

// Returns BGR. Precondition: the collector has received an image.
cv::Mat draw_coverage(const ViewCollector& collector);

}  // namespace rumi::tool
