// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/matching/epipolar_matches.h"

#include <algorithm>

#include "front_tracker/matching/reference_tracks.h"
#include "slam/geometry/epipolar.h"

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

size_t count_agreeing(const Camera& camera, const SE3& cam_from_submap, const EpipolarView& view) {
  constexpr double kSigmas = 3;
  const double f = 0.5 * (camera.fx + camera.fy);
  const Eigen::Matrix3d essential = essential_matrix(cam_from_submap * view.cam_from_submap.inverse());
  return static_cast<size_t>(
      std::count_if(view.matches.begin(), view.matches.end(), [&](const EpipolarView::Match& match) {
        return f * sampson_distance(essential, camera.ray(match.pixel_there), camera.ray(match.pixel)) <=
               kSigmas * match.sigma_px;
      }));
}

}  // namespace rumi::front_tracker
