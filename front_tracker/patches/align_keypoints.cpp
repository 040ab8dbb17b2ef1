// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/patches/align_keypoints.h"

#include "front_tracker/patches/landmark_patch.h"

namespace rumi::front_tracker {

bool align_keypoints(const FrontSubmap& submap, Frame* frame, PatchTemplates* templates) {
  if (!frame->images || submap.images.empty()) return false;
  const ImagedView view{frame->cam_from_submap, *frame->images};
  auto features = std::make_shared<Features>(*frame->features);
  for (size_t i = 0; i < frame->landmark_ids.size(); ++i) {
    const Landmark* lm = frame->landmark_ids[i] == kNone ? nullptr : submap.map.landmark(frame->landmark_ids[i]);
    if (!lm) continue;
    if (const auto found = find_patch(submap, lm->position, lm->observations, view, features->keypoints[i], templates))
      features->move(i, found->pixel, submap.map.camera);
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
  const auto found = find_patch(submap_, position, references, {kf.cam_from_submap, *images->second},
                                kf.features->keypoints[keypoint], &templates);
  if (!found) return false;
  if (!moved_) kf.features = moved_ = std::make_shared<Features>(*kf.features);
  moved_->move(keypoint, found->pixel, submap_.map.camera);
  return true;
}

KeyframeAligner::~KeyframeAligner() {
  if (moved_) submap_.keypoints_moved(id_);
}

}  // namespace rumi::front_tracker
