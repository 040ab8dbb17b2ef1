// SPDX-License-Identifier: BSD-3-Clause
// The colours of the pictures (R, G, B). They can be told apart with any colour vision (after Okabe and Ito). What
// matters also differs in lightness or shape.
#pragma once

#include <opencv2/core.hpp>

#include "slam/map/submap.h"

namespace rumi::viewer_offscreen {

// Returns the colour of a submap: cool for front submaps, warm for back submaps. `number` is its number among those of
// its kind.
inline cv::Vec3b submap_color(SubmapKind kind, int number) {
  static const cv::Vec3b kFront[] = {{0, 114, 178}, {0, 158, 115}, {86, 180, 233}, {150, 95, 170}};
  static const cv::Vec3b kBack[] = {{213, 94, 0}, {230, 159, 0}};
  return kind == SubmapKind::kBack ? kBack[number % 2] : kFront[number % 4];
}

inline const cv::Vec3b kPaperColor{246, 246, 243}, kPanelColor{255, 255, 255}, kFrameColor{214, 214, 210},
    kGridColor{226, 228, 232}, kShadowColor{205, 207, 212}, kCameraColor{25, 25, 30};
inline const cv::Vec3b kTruthColor{30, 30, 30}, kMergeColor{50, 50, 56};
inline const cv::Vec3b kLostColor{120, 30, 40}, kRecentlyLostColor{190, 120, 130}, kNotInitializedColor{176, 178, 184};

}  // namespace rumi::viewer_offscreen
