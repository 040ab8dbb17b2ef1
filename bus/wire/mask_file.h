// SPDX-License-Identifier: BSD-3-Clause
// Reads a mask that a user gives: a PNG file, black where something else than the world is seen. The resulting image is
// 255 in the world, and 0 where pixels are left out. Errors name the file and what to do.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "base/result.h"

namespace rumi {

// Reads the mask of one image of this size. An Error if the file is no such mask.
Result<cv::Mat> read_mask_file(const std::string& file, const cv::Size& size);
// Reads the mask of all images of a camera: a mask that leaves out everything is an Error, too.
Result<cv::Mat> read_camera_mask(const std::string& file, const cv::Size& size);
// Checks only the file's header: an Error if it is no PNG of this size.
Result<> check_mask_file(const std::string& file, const cv::Size& size);

// Returns the share of the image (0 to 1) that the mask leaves out.
double share_left_out(const cv::Mat& mask);

}  // namespace rumi
