// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "base/result.h"
#include "rumi/evaluation/metrics.h"

namespace rumi::tool {

// Draws estimate and truth in the plane in which the truth extends most, and the error over time. Returns BGR.
cv::Mat draw_evaluation(const RunMetrics& metrics, const std::vector<TimedPose>& truth);
// Writes draw_evaluation() into a file. An Error if it cannot be written.
Result<> plot_evaluation(const RunMetrics& metrics, const std::vector<TimedPose>& truth, const std::string& png_file);

}  // namespace rumi::tool
