// SPDX-License-Identifier: BSD-3-Clause
// Measures how far the picture moved from one image to the next, and how sharp it is, for the thinning of a gap. It is
// cheap: it works on images reduced to some 160 pixels of width.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::ruminator {

struct ImageMeasure {
  // Median displacement since the image before, pixels of the full resolution. Nothing for the first image, and for one
  // in which nothing could be followed (black, blurred beyond use, another scene).
  std::optional<double> motion_px;
  // Energy of the fine structure over that of the whole picture. It depends on the scene, so only neighbours can be
  // compared. 0: black, or no image.
  double sharpness = 0;
};

class ImageMotion {
 public:
  // Measures the next image, in order of time.
  ImageMeasure measure(const image_t& image);
  // Makes the next image the first.
  void reset() { previous_.release(); }

 private:
  cv::Mat previous_;  // reduced, grey; empty: none
};

// The two ways of measuring, on reduced images of the same size, in their pixels.
// Follows corners there and back (Lucas-Kanade). Returns the median length of those that return to where they began.
std::optional<double> motion_of_corners(const cv::Mat& from, const cv::Mat& to);
// Finds one displacement for the whole picture. It is blind to turns about the optical axis, but needs no corners.
std::optional<double> motion_of_picture(const cv::Mat& from, const cv::Mat& to);
double sharpness_of(const cv::Mat& grey);

}  // namespace rumi::ruminator
