// SPDX-License-Identifier: BSD-3-Clause
// Finds the parts of a camera's images that never move while the rest does: a bonnet, a caption, a rim, dust on the
// lens. They do not belong to the world, however well they can be tracked.
//
// For each pixel, the sum of its gradients over time is compared with the sum of their squared lengths. Gradients of
// the world point in all directions as it passes; those of a bonnet's edge agree. Only images that differ enough from
// the last one are used, so a camera that stands still changes nothing.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "slam/features/image_mask.h"

namespace rumi::front_tracker {

class StillParts {
 public:
  // Takes 8-bit grey images of one size, in order of time. Returns true if the mask has changed. Pixels that `known`,
  // the user's mask, leaves out are ignored.
  bool add(int64_t utime_us, const cv::Mat& grey, const ImageMask& known = {});

  const ImageMask& mask() const { return mask_; }
  // Returns the number of images that were used so far.
  int looks() const { return looks_; }

 private:
  bool has_changed(const cv::Mat& dx, const cv::Mat& dy) const;
  void accumulate(const cv::Mat& dx, const cv::Mat& dy);
  bool judge(const ImageMask& known);
  cv::Mat still_cells() const;

  int64_t last_utime_us_ = INT64_MIN;
  int looks_ = 0;
  double weight_ = 0;          // total weight of the images in the sums
  cv::Mat last_dx_, last_dy_;  // gradients of the last image that was used
  cv::Mat sum_dx_, sum_dy_;    // sums of the gradients
  cv::Mat sum_square_;         // sum of the squares of their lengths
  cv::Mat cells_;              // 255: the cell is still; without the parts that fill_bays() and fill_holes() add
  ImageMask mask_;
};

}  // namespace rumi::front_tracker
