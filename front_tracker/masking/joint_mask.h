// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slam/features/image_mask.h"

namespace rumi::front_tracker {

// The pixels that two masks show. It is computed again only if one of them has changed.
class JointMask {
 public:
  const ImageMask& join(const ImageMask& a, const ImageMask& b) {
    if (a.pixels().data != a_.data || b.pixels().data != b_.data) joint_ = a.and_also(b);
    a_ = a.pixels();  // kept alive, so that no new mask gets its address
    b_ = b.pixels();
    return joint_;
  }

 private:
  cv::Mat a_, b_;
  ImageMask joint_;
};

}  // namespace rumi::front_tracker
