// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/patches/landmark_patch.h"

#include <Eigen/LU>
#include <cmath>

#include "slam/features/keypoint_whitening.h"
#include "slam/features/orb_extractor.h"
#include "slam/features/patch_alignment.h"

namespace rumi::front_tracker {
namespace {

constexpr int kReferences = 2;     // keyframes that are tried, at most
constexpr float kPatchMargin = 3;  // pixels of the level around the point that the mask must not leave out
constexpr double kStep_px = 4;     // pixels between the points whose projections determine a patch's distortion

// Returns a matrix whose columns say how steps from the point in x and y, parallel to the reference's image plane,
// appear in the image. Returns nullopt if a projection fails.
std::optional<Eigen::Matrix2d> projected_steps(const Camera& camera, const SE3& cam_from_reference,
                                               const Eigen::Vector3d& point) {
  const auto center = camera.project(cam_from_reference * point);
  const double step = kStep_px * point.z();
  const auto x = camera.project(cam_from_reference * Eigen::Vector3d(point + Eigen::Vector3d(step / camera.fx, 0, 0)));
  const auto y = camera.project(cam_from_reference * Eigen::Vector3d(point + Eigen::Vector3d(0, step / camera.fy, 0)));
  if (!center || !x || !y) return std::nullopt;
  Eigen::Matrix2d steps;
  steps << *x - *center, *y - *center;
  return steps;
}

// Returns a matrix whose columns say how steps of a pixel in the reference appear in the view, near the landmark at
// `position`. The surface is assumed to be parallel to the reference's image plane.
std::optional<Eigen::Matrix2f> view_from_reference(const Camera& camera, const Eigen::Vector3d& position,
                                                   const SE3& reference_from_submap, const SE3& view_from_submap) {
  const Eigen::Vector3d point = reference_from_submap * position;
  const auto there = projected_steps(camera, SE3(), point);
  const auto here = projected_steps(camera, view_from_submap * reference_from_submap.inverse(), point);
  if (!there || !here || !(std::abs(there->determinant()) > 1e-6)) return std::nullopt;
  return Eigen::Matrix2d(*here * there->inverse()).cast<float>();
}

// Returns the rotation in the image plane that is nearest to the steps.
float turn_rad(const Eigen::Matrix2f& steps) {
  return std::atan2(steps(1, 0) - steps(0, 1), steps(0, 0) + steps(1, 1));
}

}  // namespace

std::optional<Keypoint> find_patch(const FrontSubmap& submap, const Eigen::Vector3d& position,
                                   const std::vector<Observation>& references, const ImagedView& view,
                                   const Keypoint& at, PatchTemplates* templates) {
  if (at.octave >= view.images.levels()) return std::nullopt;
  int tried = 0;
  for (const Observation& o : references) {
    const auto images = submap.images.find(o.keyframe_id);
    if (images == submap.images.end() || images->second.get() == &view.images) continue;
    const Keyframe& kf = *submap.map.keyframe(o.keyframe_id);
    const Keypoint& seen = kf.features->keypoints[o.keypoint_index];
    const auto steps = view_from_reference(submap.map.camera, position, kf.cam_from_submap, view.cam_from_submap);
    const PatchTemplate* patch = steps ? templates->find(*images->second, {o, seen.pixel, *steps, at.octave}) : nullptr;
    const auto pixel = patch ? align_patch(*patch, {view.images, at.pixel, at.octave}) : std::nullopt;
    if (pixel) return Keypoint{*pixel, seen.angle_rad + turn_rad(*steps), at.octave};
    if (++tried == kReferences) break;
  }
  return std::nullopt;
}

bool is_inside(const ImagePyramid& images, const Keypoint& keypoint) {
  const Eigen::Vector2f at = images.to_level(keypoint.pixel, keypoint.octave);
  const cv::Mat& level = images.level(keypoint.octave);
  return at.minCoeff() >= kOrbBorder_px && at.x() < static_cast<float>(level.cols) - kOrbBorder_px &&
         at.y() < static_cast<float>(level.rows) - kOrbBorder_px &&
         images.shows_world(keypoint.pixel, keypoint.octave, kPatchMargin);
}

void add_keypoint(const Submap& map, const Landmark& landmark, const ImagePyramid& images, const Keypoint& keypoint,
                  Features* features) {
  const Eigen::Vector2f at = images.to_level(keypoint.pixel, keypoint.octave);
  const Observation& latest = landmark.observations.back();
  features->keypoints.push_back(keypoint);
  features->descriptors.push_back(map.keyframe(latest.keyframe_id)->features->descriptors[latest.keypoint_index]);
  features->undistorted.push_back(map.camera.undistort(keypoint.pixel.cast<double>()).cast<float>());
  features->whitenings.push_back(keypoint_whitening(images.level(keypoint.octave), {at.x(), at.y()}));
}

}  // namespace rumi::front_tracker
