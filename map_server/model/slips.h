// SPDX-License-Identifier: BSD-3-Clause
// Finds where the scale of a submap slipped. While a camera moves along a bare wall, a quarter of the scale can be lost
// within a second although dozens of landmarks agree with one another. A loop within the submap tells of it later. Then
// not the whole loop must be bent for what happened at one place.
#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "map_server/links/joint.h"
#include "map_server/model/map_model.h"

namespace rumi::map_server {

struct Slip {
  SubmapKey submap;
  int keyframe = kNone;  // the last one before the slip

  // True if it lies between these keyframes of the submap.
  bool is_between(int a, int b) const { return std::min(a, b) <= keyframe && keyframe < std::max(a, b); }
};

// A joint between two keyframes of one submap tells of a slip between them if their scales differ. The slip is where
// the fewest landmarks are seen from both sides, among the places where the joint lets the camera go on from about
// where it was, and that no other joint spans whose scales are the same. Without such a place there is no slip: the
// scale drifted, or the joint is wrong.
std::vector<Slip> find_slips(const std::vector<KeyframeJoint>& joints,
                             const std::map<SubmapKey, PlacedSubmap>& submaps);

}  // namespace rumi::map_server
