// SPDX-License-Identifier: BSD-3-Clause
// The data association that joins submaps, over time (the paper's Fig. 7). It covers every image that is a keyframe of
// several submaps, and counts the landmarks that two of them have at the same keypoint (M_com).
#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "map_server/atlas/atlas.h"

namespace rumi::tool {

struct ImageMatches {
  int matched = 0;   // features, summed over all pairs of submaps
  int verified = 0;  // matched features whose reprojection agrees with the similarity of the pair's link
};

struct MatchHistory {
  std::map<int64_t, ImageMatches> front;  // by utime_us: pairs of front submaps
  std::map<int64_t, ImageMatches> back;   // by utime_us: pairs with a back submap
  // Stretches of frames that no front submap has: first and last utime_us.
  std::vector<std::pair<int64_t, int64_t>> untracked;
  int64_t first_us = 0, last_us = 0;  // first and last utime_us of all frames

  bool empty() const { return front.empty() && back.empty(); }
};

// max_reprojection_px: limit for verified matches, see AlignmentOptions.
MatchHistory match_history(const map_server::Atlas& atlas, double max_reprojection_px);

cv::Mat draw_matches(const MatchHistory& history);

}  // namespace rumi::tool
