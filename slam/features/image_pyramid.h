// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "slam/features/image_mask.h"

namespace rumi {

// An 8-bit grey image in several sizes, and the mask of the pixels that show the world.
class ImagePyramid {
 public:
  // `scales`: pixel size of each level in pixels of the full image, growing from 1. Levels without pixels are left out.
  ImagePyramid(const cv::Mat& grey, const std::vector<double>& scales, const ImageMask& mask = {});

  // Returns the full image without the smaller ones, which can be made from it again. Shares the image's pixels.
  ImagePyramid full_image_alone() const { return ImagePyramid(images_[0], {1.0}, mask_); }

  const ImageMask& mask() const { return mask_; }  // mask of the full image
  // True if a corner of level i at this pixel of the full image belongs to the world: the mask leaves out nothing
  // within `radius` pixels of the level.
  bool shows_world(const Eigen::Vector2f& full, int i, float radius) const {
    return mask_.allows(full, radius * pixel_size(i).x());
  }
  int levels() const { return static_cast<int>(images_.size()); }
  const cv::Mat& level(int i) const { return images_[i]; }
  // The size of the level's pixels in pixels of the full image, in x and y. The two differ a little because an image
  // has a whole number of pixels.
  Eigen::Vector2f pixel_size(int i) const {
    return {static_cast<float>(images_[0].cols) / static_cast<float>(images_[i].cols),
            static_cast<float>(images_[0].rows) / static_cast<float>(images_[i].rows)};
  }
  // Convert between pixels of the full image and of a level. In both, (0, 0) is the centre of the upper-left pixel.
  Eigen::Vector2f to_level(const Eigen::Vector2f& full, int i) const {
    return (full.array() + 0.5F) / pixel_size(i).array() - 0.5F;
  }
  Eigen::Vector2f to_full(const Eigen::Vector2f& at_level, int i) const {
    return (at_level.array() + 0.5F) * pixel_size(i).array() - 0.5F;
  }

 private:
  std::vector<cv::Mat> images_;
  ImageMask mask_;
};

}  // namespace rumi
