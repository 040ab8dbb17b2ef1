// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/matching/epipolar_matches.h"

#include <algorithm>

#include "front_tracker/matching/reference_tracks.h"

namespace rumi::front_tracker {

EpipolarView match_epipolar(const Camera& camera, const std::vector<double>& scales, const EarlierView& earlier,
                            const Frame& frame) {
  const Features &then = *earlier.features, &now = *frame.features;
  ReferenceTracks tracks(earlier.features);
  tracks.follow(camera, estimate_motion(camera, then, now), frame);
  const std::vector<int>& found = tracks.found().back();
  EpipolarView view{earlier.cam_from_submap, {}};
  for (size_t i = 0; i < found.size(); ++i) {
    if (found[i] == kNone || (earlier.landmark_ids[i] != kNone && frame.landmark_ids[found[i]] != kNone)) continue;
    const int octave = std::max(then.keypoints[i].octave, now.keypoints[found[i]].octave);
    view.matches.push_back(
        {then.undistorted[i].cast<double>(), now.undistorted[found[i]].cast<double>(), scales[octave]});
  }
  return view;
}

}  // namespace rumi::front_tracker
