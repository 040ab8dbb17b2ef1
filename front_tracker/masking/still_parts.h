// SPDX-License-Identifier: BSD-3-Clause
// What never moves in the images of a camera while the rest of them does: a bonnet, a caption, a rim, dust on the lens.
// It is not the world, however well it can be tracked.
//
// Of each pixel the sum of its gradients over time is held against the sum of their lengths: gradients of the world
// point every way while it passes, those of a bonnet's edge agree. Images are looked at only when enough has changed
// since the last one, so a camera that stands tells nothing.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "slam/features/image_mask.h"

namespace rumi::front_tracker {

class StillParts {
 public:
  // 8-bit grey images of one size, in order of time. True if the mask has changed. What `known` leaves out, the user's
  // mask, is not looked at.
  bool add(int64_t utime_us, const cv::Mat& grey, const ImageMask& known = {});

  const ImageMask& mask() const { return mask_; }
  // Images that were looked at so far.
  int looks() const { return looks_; }

 private:
  bool has_changed(const cv::Mat& dx, const cv::Mat& dy) const;
  void accumulate(const cv::Mat& dx, const cv::Mat& dy);
  bool judge(const ImageMask& known);
  cv::Mat still_cells() const;

  int64_t last_utime_us_ = INT64_MIN;
  int looks_ = 0;
  double weight_ = 0;          // of the images in the sums
  cv::Mat last_dx_, last_dy_;  // of the last image that was looked at
  cv::Mat sum_dx_, sum_dy_;    // of the gradients
  cv::Mat sum_square_;         // of the squares of their lengths
  cv::Mat cells_;              // 255: still, without what is filled in
  ImageMask mask_;
};

}  // namespace rumi::front_tracker
