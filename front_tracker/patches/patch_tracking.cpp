// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/patches/patch_tracking.h"

#include <algorithm>

#include "front_tracker/patches/landmark_patch.h"

namespace rumi::front_tracker {
namespace {

constexpr size_t kFew = 50;
// Levels by which the search for few landmarks is coarser: it reaches 3.5 pixels of the full image or more.
constexpr int kCoarser = 3;
constexpr int kLeastOfFew = 20;  // inliers, when few landmarks are looked for

// A landmark to look for, and its octave in the last frame.
struct Sought {
  const Landmark* landmark;
  uint8_t octave;
};

std::vector<Sought> landmarks_of(const Submap& map, const Frame& frame) {
  std::vector<Sought> sought;
  for (size_t i = 0; i < frame.landmark_ids.size(); ++i)
    if (const Landmark* lm = frame.landmark_ids[i] == kNone ? nullptr : map.landmark(frame.landmark_ids[i]))
      sought.push_back({lm, frame.features->keypoints[i].octave});
  return sought;
}

PatchTracking track(const FrontSubmap& submap, const std::vector<Sought>& landmarks, Frame* frame, int coarser,
                    PatchTemplates* templates) {
  const Camera& camera = submap.map.camera;
  const ImagedView view{frame->cam_from_submap, *frame->images};
  PatchTracking result;
  Features features;
  frame->landmark_ids.clear();
  for (const auto& [lm, octave] : landmarks) {
    const auto predicted = camera.project(view.cam_from_submap * lm->position);
    if (!predicted) continue;
    Keypoint at{predicted->cast<float>(), 0, octave};
    if (!is_inside(view.images, at)) continue;
    ++result.in_view;
    at.octave = static_cast<uint8_t>(std::min(octave + coarser, view.images.levels() - 1));
    const auto found = find_patch(submap, lm->position, lm->observations, view, at, templates);
    if (!found || !is_inside(view.images, *found)) continue;
    add_keypoint(submap.map, *lm, view.images, *found, &features);
    frame->landmark_ids.push_back(lm->id);
  }
  frame->features = std::make_shared<const Features>(std::move(features));
  result.inliers = refine_pose(camera, submap.map, submap.octave_scales, frame);
  return result;
}

}  // namespace

bool find_pose_by_patches(const FrontSubmap& submap, const Frame& last, Frame* frame, PatchTemplates* templates) {
  std::vector<Sought> few;
  const std::vector<Sought> all = landmarks_of(submap.map, last);
  for (size_t i = 0; i < all.size(); i += std::max<size_t>(1, all.size() / kFew)) few.push_back(all[i]);
  return track(submap, few, frame, kCoarser, templates).inliers >= kLeastOfFew;
}

PatchTracking track_by_patches(const FrontSubmap& submap, const Frame& last, Frame* frame, PatchTemplates* templates) {
  const PatchTracking result = track(submap, landmarks_of(submap.map, last), frame, 0, templates);
  templates->end_frame();
  return result;
}

}  // namespace rumi::front_tracker
