// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/frame/scale_support.h"

#include <algorithm>
#include <cmath>

namespace rumi::front_tracker {

// A landmark of two keyframes lies where their motion put it. Where a frame sees nothing else (nearly all is lost in a
// turn, what mapping has just made is left), a wrong length of that motion is all there is from then on.
// So it is with one of little parallax, unless many sights make up for it: it counts by how well its distance is known,
// the information of the mean of its sights.
bool carries_scale(const Submap& map, const Frame& frame, const TrackingOptions& options) {
  constexpr size_t kYoung = 5;  // keyframes: of a submap that has nothing established
  if (map.keyframes.size() < kYoung) return true;
  const double min_parallax_rad = options.min_established_parallax_deg * M_PI / 180;
  double established = 0;
  for (int id : frame.landmark_ids) {
    const Landmark* lm = id == kNone ? nullptr : map.landmark(id);
    if (!lm || lm->observations.size() < 3) continue;
    const double sights = static_cast<double>(lm->observations.size());
    established += std::min(1.0, sights / 3 * std::pow(lm->parallax_rad / min_parallax_rad, 2));
  }
  return established >= options.min_established;
}

}  // namespace rumi::front_tracker
