// SPDX-License-Identifier: BSD-3-Clause
// Draws in a child process, so that what OpenGL takes (170 MB with OSMesa) is taken only while a picture is drawn.
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>

#include "base/result.h"

namespace rumi::viewer_offscreen {

// Runs draw() in a copy of this process and returns its picture, 8-bit BGR of this size. An Error says what draw()
// threw, that it returned another size, or that the child died or took longer than `timeout_s`.
Result<cv::Mat> draw_in_child(const cv::Size& size, const std::function<cv::Mat()>& draw, double timeout_s = 30);

}  // namespace rumi::viewer_offscreen
