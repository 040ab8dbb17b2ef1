// SPDX-License-Identifier: BSD-3-Clause
// Measures how far the picture moves from one image to the next, and how sharp it is, for the thinning of a gap. It is
// cheap, because it works on images reduced to a width of about 160 pixels.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::ruminator {

struct ImageMeasure {
  // Median displacement since the previous image, in pixels of the full resolution. nullopt for the first image, and if
  // nothing could be followed (black, too blurred, another scene).
  std::optional<double> motion_px;
  // Energy of the fine structure over that of the whole picture. It depends on the scene, so only neighbouring frames
  // can be compared. 0 if the image is black or broken.
  double sharpness = 0;
};

class ImageMotion {
 public:
  // Measures the next image, in order of time.
  ImageMeasure measure(const image_t& image);
  // Forgets the previous image.
  void reset() { previous_.release(); }

 private:
  cv::Mat previous_;  // reduced, grey; empty if there is no previous image
};

// The two ways to measure motion, both in pixels of reduced images of the same size. nullopt if they fail.
// motion_of_corners() follows corners forth and back (Lucas-Kanade), and returns the median motion of those that return
// to where they began.
std::optional<double> motion_of_corners(const cv::Mat& from, const cv::Mat& to);
// Finds one displacement for the whole picture. It cannot measure rotations about the optical axis, but needs no
// corners.
std::optional<double> motion_of_picture(const cv::Mat& from, const cv::Mat& to);
double sharpness_of(const cv::Mat& grey);

}  // namespace rumi::ruminator
