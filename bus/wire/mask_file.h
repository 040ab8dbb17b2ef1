// SPDX-License-Identifier: BSD-3-Clause
// A mask of the user's: a PNG file, black where something else than the world is seen.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace rumi {

struct MaskFile {
  cv::Mat pixels;     // 255: the world, 0: left out
  std::string error;  // empty, or file, what is wrong, and what to do
  bool ok() const { return error.empty(); }
  double left_out() const;  // share of the image
};

// For images of `size`. One that does not fit them is an error.
MaskFile read_mask_file(const std::string& file, const cv::Size& size);
// The same for all images of a camera: one that leaves out all of them is an error, too.
MaskFile read_camera_mask(const std::string& file, const cv::Size& size);
// Why it would not fit, as far as the beginning of the file tells; or an empty string.
std::string why_unfit(const std::string& file, const cv::Size& size);

}  // namespace rumi
