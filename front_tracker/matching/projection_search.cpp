// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/matching/projection_search.h"

#include "slam/features/matching.h"
#include "slam/map/landmark_view.h"

namespace rumi::front_tracker {

std::optional<Prediction> predict(const Camera& camera, const SE3& cam_from_submap, const Landmark& landmark,
                                  const std::vector<double>& scales, double min_view_cosine) {
  const Eigen::Vector3d p = cam_from_submap * landmark.position;
  if (!(p.z() > 0)) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project_undistorted(p);
  // Barrel distortion makes the undistorted image larger than the real one, so the border is that of the real image.
  const auto real = camera.has_distortion() ? camera.project(p) : std::optional(pixel);
  if (!real || !camera.contains(*real)) return std::nullopt;
  const double distance = p.norm();
  const Eigen::Vector3d direction = cam_from_submap.rotation.conjugate() * p / distance;
  if (direction.dot(landmark.view_direction) < min_view_cosine) return std::nullopt;
  // From much closer or farther, the landmark's octave would lie outside the pyramid.
  if (distance > 1.3 * landmark.octave0_distance || distance * scales.back() * 1.3 < landmark.octave0_distance)
    return std::nullopt;
  return Prediction{pixel.cast<float>(), predict_octave(landmark, distance, scales)};
}

int find_keypoint(const Frame& frame, const Prediction& at, const Descriptor& descriptor,
                  const ProjectionSearch& search, const std::vector<double>& scales) {
  const float radius = static_cast<float>(search.radius_px * scales[at.octave]);
  const int lowest = at.octave - search.octaves_below, highest = at.octave + search.octaves_above;
  BestMatch best;
  const Features& features = *frame.features;
  frame.grid.for_each_near(at.pixel, radius, [&](int i) {
    const int octave = features.keypoints[i].octave;
    if (octave < lowest || octave > highest || frame.landmark_ids[i] != kNone) return;
    if ((features.undistorted[i] - at.pixel).squaredNorm() > radius * radius) return;
    best.offer(hamming_distance(descriptor, features.descriptors[i]), i);
  });
  if (best.index == kNone || best.distance > search.max_distance) return kNone;
  // A very good match is accepted all the same: the second may be the same corner at another octave.
  if (best.distance > search.max_ratio * best.second_distance && best.second_distance <= search.max_distance &&
      best.distance > search.max_distance / 2)
    return kNone;
  return best.index;
}

int search_by_projection(const Camera& camera, const std::vector<const Landmark*>& landmarks,
                         const ProjectionSearch& search, const std::vector<double>& scales, Frame* frame,
                         std::vector<int>* visible) {
  int found = 0;
  for (const Landmark* lm : landmarks) {
    const auto at = predict(camera, frame->cam_from_submap, *lm, scales, search.min_view_cosine);
    if (!at) continue;
    if (visible) visible->push_back(lm->id);
    const int keypoint = find_keypoint(*frame, *at, lm->descriptor, search, scales);
    if (keypoint == kNone) continue;
    frame->landmark_ids[keypoint] = lm->id;
    ++found;
  }
  return found;
}

}  // namespace rumi::front_tracker
