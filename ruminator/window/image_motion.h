// SPDX-License-Identifier: BSD-3-Clause
// How far the picture moved from one image to the next, and how sharp it is: what the thinning of a gap goes by. Cheap,
// from images reduced to some 160 pixels of width.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::ruminator {

struct ImageMeasure {
  // Median displacement since the image before, pixels of the full resolution. Nothing: the first image, or one in
  // which nothing could be followed (black, blurred beyond use, another scene).
  std::optional<double> motion_px;
  // Energy of fine structure over that of the whole picture. Comparable between neighbours only: it depends on what is
  // in view. 0: black, or no image.
  double sharpness = 0;
};

class ImageMotion {
 public:
  // The next image, in order of time.
  ImageMeasure measure(const image_t& image);
  // The next image is the first.
  void reset() { previous_.release(); }

 private:
  cv::Mat previous_;  // reduced, grey; empty: none
};

// The two ways of measuring, on reduced images of one size; pixels of these.
// Corners followed there and back (Lucas-Kanade): the median length of those that returned to where they came from.
std::optional<double> motion_of_corners(const cv::Mat& from, const cv::Mat& to);
// One displacement for the whole picture. Blind to turns about the optical axis, but needs no corners.
std::optional<double> motion_of_picture(const cv::Mat& from, const cv::Mat& to);
double sharpness_of(const cv::Mat& grey);

}  // namespace rumi::ruminator
