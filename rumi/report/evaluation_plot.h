// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "base/result.h"
#include "rumi/evaluation/metrics.h"

namespace rumi::tool {

// Error over time, and estimate and truth from the side from which they are widest. BGR.
cv::Mat draw_evaluation(const RunMetrics& metrics, const std::vector<TimedPose>& truth);
// Writes draw_evaluation() into a file. An Error if it cannot be written.
Result<> plot_evaluation(const RunMetrics& metrics, const std::vector<TimedPose>& truth, const std::string& png_file);

}  // namespace rumi::tool
