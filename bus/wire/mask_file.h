// SPDX-License-Identifier: BSD-3-Clause
// A mask that a user gives: a PNG file, black where something else than the world is seen. Pixels that are read are 255
// in the world, and 0 where the image is left out. Errors name the file and what to do.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "base/result.h"

namespace rumi {

// The mask of one image of this size.
Result<cv::Mat> read_mask_file(const std::string& file, const cv::Size& size);
// The mask of all images of a camera: one that leaves out everything is an Error, too.
Result<cv::Mat> read_camera_mask(const std::string& file, const cv::Size& size);
// Looks only at the file's header.
Result<> check_mask_file(const std::string& file, const cv::Size& size);

// The share of the image that the mask leaves out.
double share_left_out(const cv::Mat& mask);

}  // namespace rumi
