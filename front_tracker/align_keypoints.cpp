// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/align_keypoints.h"

#include <Eigen/LU>
#include <optional>

#include "slam/features/patch_alignment.h"

namespace rumi {
namespace {

constexpr int kReferences = 2;  // keyframes that are tried
constexpr double kStep_px = 4;  // between the points whose projections tell how a patch is distorted

// One view of a landmark: the camera's pose, and its image.
struct ImagedView {
  const SE3& cam_from_submap;
  const ImagePyramid& images;
};

// How steps from the point, parallel to the reference's image plane in x and y (columns), appear in the image.
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

// How steps of a pixel in the reference appear in the view, near the landmark at `position`. The surface is taken to be
// parallel to the reference's image plane.
std::optional<Eigen::Matrix2f> view_from_reference(const Camera& camera, const Eigen::Vector3d& position,
                                                   const SE3& reference_from_submap, const SE3& view_from_submap) {
  const Eigen::Vector3d point = reference_from_submap * position;
  const auto there = projected_steps(camera, SE3(), point);
  const auto here = projected_steps(camera, view_from_submap * reference_from_submap.inverse(), point);
  if (!there || !here || !(std::abs(there->determinant()) > 1e-6)) return std::nullopt;
  return Eigen::Matrix2d(*here * there->inverse()).cast<float>();
}

// The pixel (as detected) where `keypoint`, of the view, looks as in the first of the submap's observations of the
// landmark at `position` whose images are kept; the view's own is none of them.
std::optional<Eigen::Vector2f> aligned_pixel(const FrontSubmap& submap, const Eigen::Vector3d& position,
                                             const std::vector<Observation>& references, const ImagedView& view,
                                             const Keypoint& keypoint, PatchTemplates* templates) {
  if (keypoint.octave >= view.images.levels()) return std::nullopt;
  int tried = 0;
  for (const Observation& o : references) {
    const auto images = submap.images.find(o.keyframe_id);
    if (images == submap.images.end() || images->second.get() == &view.images) continue;
    const Keyframe& kf = *submap.map.keyframe(o.keyframe_id);
    const auto steps = view_from_reference(submap.map.camera, position, kf.cam_from_submap, view.cam_from_submap);
    const PatchTemplate* patch =
        steps ? templates->find(*images->second,
                                {o, kf.features->keypoints[o.keypoint_index].pixel, *steps, keypoint.octave})
              : nullptr;
    const auto pixel = patch ? align_patch(*patch, {view.images, keypoint.pixel, keypoint.octave}) : std::nullopt;
    if (pixel) return pixel;
    if (++tried == kReferences) break;
  }
  return std::nullopt;
}

}  // namespace

bool align_keypoints(const FrontSubmap& submap, Frame* frame, PatchTemplates* templates) {
  if (!frame->images || submap.images.empty()) return false;
  const ImagedView view{frame->cam_from_submap, *frame->images};
  auto features = std::make_shared<Features>(*frame->features);
  for (size_t i = 0; i < frame->landmark_ids.size(); ++i) {
    const Landmark* lm = frame->landmark_ids[i] == kNone ? nullptr : submap.map.landmark(frame->landmark_ids[i]);
    if (!lm) continue;
    if (const auto pixel =
            aligned_pixel(submap, lm->position, lm->observations, view, features->keypoints[i], templates))
      features->move(i, *pixel, submap.map.camera);
  }
  templates->end_frame();
  frame->features = std::move(features);
  frame->grid = KeypointGrid(frame->features->undistorted, submap.map.camera);
  return true;
}

bool KeyframeAligner::align(int keypoint, const Eigen::Vector3d& position, const std::vector<Observation>& references) {
  const auto images = submap_.images.find(id_);
  if (images == submap_.images.end()) return false;
  Keyframe& kf = *submap_.map.keyframe(id_);
  PatchTemplates templates;
  const auto pixel = aligned_pixel(submap_, position, references, {kf.cam_from_submap, *images->second},
                                   kf.features->keypoints[keypoint], &templates);
  if (!pixel) return false;
  if (!moved_) kf.features = moved_ = std::make_shared<Features>(*kf.features);
  moved_->move(keypoint, *pixel, submap_.map.camera);
  return true;
}

KeyframeAligner::~KeyframeAligner() {
  if (moved_) submap_.keypoints_moved(id_);
}

}  // namespace rumi
