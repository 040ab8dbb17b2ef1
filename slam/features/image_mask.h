// SPDX-License-Identifier: BSD-3-Clause
// Which pixels of an image show the world: no landmark is made of the others (a bonnet, a caption, a lens's rim).
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace rumi {

class ImageMask {
 public:
  ImageMask() = default;  // every pixel shows the world
  // 8-bit grey of the image's size; 0 is left out.
  explicit ImageMask(const cv::Mat& pixels);

  // Every pixel shows the world.
  bool is_everything() const { return clearance_.empty(); }
  // Whether nothing nearer than `margin_px` to the pixel is left out; beyond the image it is as at its border.
  bool allows(const Eigen::Vector2f& pixel, float margin_px = 0) const;
  // Share of the pixels that are left out.
  double left_out() const;
  // As it was given; empty for everything.
  const cv::Mat& pixels() const { return pixels_; }

  // The same for an image of another size: a pixel is left out if any part of it is.
  ImageMask resized(const cv::Size& size) const;
  // What both show. Both are of one size, or everything.
  ImageMask and_also(const ImageMask& other) const;

 private:
  cv::Mat pixels_;
  cv::Mat clearance_;  // float: distance to the nearest pixel that is left out, px
};

}  // namespace rumi
