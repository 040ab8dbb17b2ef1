// SPDX-License-Identifier: BSD-3-Clause
// A window of rendered pictures with known true poses.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "ruminator/window/window_job.h"

namespace rumi::testing {
using namespace rumi::ruminator;

struct RenderedWindow {
  WindowJob job;  // 7 + 6 + 7 frames of 320 x 240; the gap is blurred, the others have true front poses in two submaps
  std::vector<SE3> cam_from_map;  // true poses of all images
};

// Returns the window, which is rendered at the first call.
const RenderedWindow& rendered_window();

// Replaces the image by another picture.
void replace_image(WindowJob* job, size_t index, const cv::Mat& grey);

}  // namespace rumi::testing
