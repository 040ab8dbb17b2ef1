// SPDX-License-Identifier: BSD-3-Clause
// The pixels of an image that show the world. The others (a bonnet, a caption, a lens's rim) give no landmarks.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace rumi {

class ImageMask {
 public:
  ImageMask() = default;  // every pixel shows the world
  // `pixels`: 8-bit grey, as large as the image. Pixels of 0 are left out.
  explicit ImageMask(const cv::Mat& pixels);

  // True if the mask leaves out no pixel.
  bool is_everything() const { return clearance_.empty(); }
  // True if every pixel within `margin_px` shows the world. Outside the image, the nearest pixel of its border decides.
  bool allows(const Eigen::Vector2f& pixel, float margin_px = 0) const;
  // Returns the share of the pixels that are left out, 0 to 1.
  double left_out() const;
  // Returns the pixels given to the constructor; empty if every pixel shows the world.
  const cv::Mat& pixels() const { return pixels_; }

  // Returns the mask for an image of another size. A pixel is left out if this mask leaves out any part of it.
  ImageMask resized(const cv::Size& size) const;
  // Returns the mask that shows the pixels that both masks show. They must have the same size, unless one of them
  // leaves out nothing.
  ImageMask and_also(const ImageMask& other) const;

 private:
  cv::Mat pixels_;
  cv::Mat clearance_;  // distance to the nearest pixel that is left out, px, as float
};

}  // namespace rumi
