// SPDX-License-Identifier: BSD-3-Clause
// A link says how two submaps lie relative to each other. Accepted links hold the served map together.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "slam/geometry/transform.h"
#include "slam/map/submap.h"

namespace rumi::map_server {

struct Link {
  enum class Kind : int8_t {
    kSameImages = 0,  // the two submaps are made of some of the same images
    kAppearance = 1,  // the two submaps see the same place; a loop if a == b
  };
  SubmapKey a, b;
  Kind kind = Kind::kSameImages;
  Sim3 b_from_a = {};
  int keyframes = 0, keyframe_inliers = 0;  // keyframes that were compared, and those that agree
  int landmarks = 0, landmark_inliers = 0;  // landmarks in common (the paper's M_com), and those that agree
  double rmse_px = 0;                       // root mean square error of the landmarks that agree
  std::string doubt = {};                   // why the link is not accepted; empty if it is
  bool accepted() const { return doubt.empty(); }
};

// Compares bit by bit.
inline bool operator==(const Link& x, const Link& y) {
  const auto counts = [](const Link& l) {
    return std::array{l.keyframes, l.keyframe_inliers, l.landmarks, l.landmark_inliers};
  };
  return x.a == y.a && x.b == y.b && x.kind == y.kind && x.b_from_a.scale == y.b_from_a.scale &&
         x.b_from_a.rotation.coeffs() == y.b_from_a.rotation.coeffs() &&
         x.b_from_a.translation == y.b_from_a.translation && counts(x) == counts(y) && x.rmse_px == y.rmse_px &&
         x.doubt == y.doubt;
}

}  // namespace rumi::map_server
