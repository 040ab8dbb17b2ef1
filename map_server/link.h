// SPDX-License-Identifier: BSD-3-Clause
// What is known of how two submaps hang together: the outcome of an attempt to align them, also where it failed.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "slam/geometry/transform.h"
#include "slam/map/submap.h"

namespace rumi {

struct Link {
  enum class Kind : int8_t { kSameImages = 0, kAppearance = 1 };  // what the two were compared by

  SubmapKey a, b;
  Kind kind = Kind::kSameImages;
  Sim3 b_from_a = {};
  int keyframes = 0, keyframe_inliers = 0;  // in common, and those that agree with b_from_a
  int landmarks = 0, landmark_inliers = 0;
  double rmse_px = 0;      // of the inliers
  std::string doubt = {};  // why it is not believed; empty: accepted

  bool accepted() const { return doubt.empty(); }
};

// To the last bit.
inline bool operator==(const Link& x, const Link& y) {
  const auto counts = [](const Link& l) {
    return std::array{l.keyframes, l.keyframe_inliers, l.landmarks, l.landmark_inliers};
  };
  return x.a == y.a && x.b == y.b && x.kind == y.kind && x.b_from_a.scale == y.b_from_a.scale &&
         x.b_from_a.rotation.coeffs() == y.b_from_a.rotation.coeffs() &&
         x.b_from_a.translation == y.b_from_a.translation && counts(x) == counts(y) && x.rmse_px == y.rmse_px &&
         x.doubt == y.doubt;
}

}  // namespace rumi
