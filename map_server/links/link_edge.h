// SPDX-License-Identifier: BSD-3-Clause
// A link between two submaps, with the joints and matched landmarks that MapBuilder uses.
#pragma once

#include <cstdint>
#include <vector>

#include "map_server/links/joint.h"
#include "map_server/links/link.h"

namespace rumi::map_server {

// Landmarks of two submaps that are the same point, by their ids.
struct LandmarkPair {
  int a = kNone, b = kNone;
  bool operator==(const LandmarkPair&) const = default;
};

struct LinkEdge {
  Link link;
  int64_t utime_a_us = 0, utime_b_us = 0;  // the images at which the link places the submaps
  std::vector<KeyframeJoint> joints = {};  // empty if the link is refused
  std::vector<LandmarkPair> landmarks = {};
};

}  // namespace rumi::map_server
