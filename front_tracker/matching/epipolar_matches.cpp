// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/matching/epipolar_matches.h"

#include <algorithm>
#include <cmath>

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

size_t count_agreeing(const Camera& camera, const SE3& cam_from_submap, const EpipolarView& view) {
  const double f = 0.5 * (camera.fx + camera.fy);
  const SE3 cam_from_view = cam_from_submap * view.cam_from_submap.inverse();
  const Eigen::Matrix3d r = cam_from_view.rotation.toRotationMatrix();
  return static_cast<size_t>(
      std::count_if(view.matches.begin(), view.matches.end(), [&](const EpipolarView::Match& match) {
        const Eigen::Vector3d b = camera.ray(match.pixel), ra = r * camera.ray(match.pixel_there);
        const Eigen::Vector3d normal = cam_from_view.translation.cross(ra);
        const Eigen::Vector3d normal_there = r.transpose() * b.cross(cam_from_view.translation);
        const double gradient = std::sqrt(normal.head<2>().squaredNorm() + normal_there.head<2>().squaredNorm());
        return gradient > 1e-9 && std::abs(b.dot(normal)) * f <= 3 * match.sigma_px * gradient;
      }));
}

}  // namespace rumi::front_tracker
