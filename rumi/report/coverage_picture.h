// SPDX-License-Identifier: BSD-3-Clause
// What `rumi calibrate` has seen of the board: where in the image, and from which sides.
#pragma once

#include <opencv2/core/mat.hpp>

#include "rumi/calibration/view_collector.h"

namespace rumi::tool {

// BGR. Precondition: an image has come.
cv::Mat draw_coverage(const ViewCollector& collector);

}  // namespace rumi::tool
