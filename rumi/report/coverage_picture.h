// SPDX-License-Identifier: BSD-3-Clause
// The views of the board that `rumi calibrate` has seen: where in the image, and from which sides.
#pragma once

#include <opencv2/core/mat.hpp>

#include "rumi/calibration/view_collector.h"

namespace rumi::tool {

// Returns BGR. Precondition: an image has come.
cv::Mat draw_coverage(const ViewCollector& collector);

}  // namespace rumi::tool
