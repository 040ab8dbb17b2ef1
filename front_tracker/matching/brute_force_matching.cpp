// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/matching/brute_force_matching.h"

#include "slam/features/matching.h"

namespace rumi::front_tracker {

LandmarkMatches match_by_brute_force(const Submap& submap, const std::vector<double>& scales, const Features& features,
                                     const std::vector<int>& landmark_ids, const Frame& frame, int max_distance) {
  std::vector<int> known;
  for (size_t i = 0; i < landmark_ids.size(); ++i)
    if (landmark_ids[i] != kNone && submap.landmark(landmark_ids[i])) known.push_back(static_cast<int>(i));
  if (known.empty()) return {};
  LandmarkMatches matches;
  for (const Match& m : match_features(features, known, *frame.features, {}, {max_distance, 0.85})) {
    const Landmark& lm = *submap.landmark(landmark_ids[m.first]);
    matches.observations.push_back({lm.position, frame.features->undistorted[m.second].cast<double>(),
                                    scales[frame.features->keypoints[m.second].octave]});
    matches.pairs.emplace_back(m.second, lm.id);
  }
  return matches;
}

void take_inliers(const LandmarkMatches& matches, const std::vector<bool>& inlier, Frame* frame) {
  for (size_t i = 0; i < matches.pairs.size(); ++i)
    if (inlier[i]) frame->landmark_ids[matches.pairs[i].first] = matches.pairs[i].second;
}

}  // namespace rumi::front_tracker
