// SPDX-License-Identifier: BSD-3-Clause
// Binary descriptors of oriented keypoints: comparisons of smoothed pixels around them, the pattern turned with them
// (BRIEF: Calonder et al., ECCV 2010; turned: Rublee et al., "ORB", ICCV 2011). The pattern is our own
// (bench/learn_brief.cpp).
#pragma once

#include <opencv2/core/mat.hpp>

#include "slam/features/descriptor.h"

namespace rumi {

class SteeredBrief {
 public:
  static constexpr int kRadius = 17;           // pixels, from the keypoint to what is compared around it
  static constexpr int kBorder = kRadius + 2;  // where there are no descriptors, pixels

  // The image that describe() looks at, of an 8-bit image: means of 5 x 5 pixels, zero in the two outermost.
  static cv::Mat smooth(const cv::Mat& image);
  // Of a keypoint at least kBorder pixels from the border (to the nearest pixel), that points in direction `angle_rad`,
  // x towards y.
  static Descriptor describe(const cv::Mat& smooth, const cv::Point2f& at, float angle_rad);
};

}  // namespace rumi
