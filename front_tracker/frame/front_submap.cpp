// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/frame/front_submap.h"

#include <algorithm>

#include "base/memory/file_memory.h"
#include "front_tracker/frame/certainty.h"
#include "slam/map/landmark_view.h"

namespace rumi::front_tracker {

FrontSubmap::FrontSubmap(Submap known, SubmapKey key) : map(std::move(known)), octave_scales(map.pyramid.scales()) {
  map.begin_front_submap(key);
  wake();
  for (const auto& [id, kf] : map.keyframes) next_keyframe_ = id + 1;
  for (const auto& [id, lm] : map.landmarks) next_landmark_ = id + 1;
}

Keyframe& FrontSubmap::add_keyframe(Frame* frame) {
  const int id = next_keyframe_++;
  Keyframe& kf = map.add_keyframe({.id = id,
                                   .utime_us = frame->utime_us,
                                   .cam_from_submap = frame->cam_from_submap,
                                   .features = frame->features,
                                   .landmark_ids = {}});
  grids[id] = frame->grid;
  if (frame->images) images[id] = frame->images;
  for (size_t i = 0; i < frame->landmark_ids.size(); ++i) {
    if (frame->landmark_ids[i] == kNone) continue;
    if (!map.add_observation(frame->landmark_ids[i], id, static_cast<int>(i))) frame->landmark_ids[i] = kNone;
  }
  for (int landmark_id : kf.landmark_ids)
    if (landmark_id != kNone) update_landmark_view(map, map.landmark(landmark_id));
  frame->reference_keyframe = id;
  frame->cam_from_keyframe = SE3();
  return kf;
}

void FrontSubmap::add_frame(const Frame& frame) {
  map.set_frame({frame.utime_us, frame.reference_keyframe, frame.cam_from_keyframe, 0, sigmas_of(*this, frame)});
}

Landmark& FrontSubmap::add_landmark(const Eigen::Vector3d& position) {
  return map.add_landmark(next_landmark_++, position);
}

void FrontSubmap::remove_keyframe(int id, int heir) {
  map.remove_keyframe(id, heir);
  grids.erase(id);
  certainty.erase(id);
  images.erase(id);
  moved_.erase(id);
}

void FrontSubmap::cut_end(int64_t utime_us) {
  const auto is_older = [&](const auto& kf) { return kf.second.utime_us < utime_us; };
  const int heir = std::find_if(map.keyframes.rbegin(), map.keyframes.rend(), is_older)->first;
  map.remove_frames_from(utime_us);
  while (!is_older(*map.keyframes.rbegin())) remove_keyframe(map.keyframes.rbegin()->first, heir);
  std::vector<int> unseen;
  for (const auto& [id, lm] : map.landmarks)
    if (lm.observations.size() < 2) unseen.push_back(id);
  for (int id : unseen) map.remove_landmark(id);
}

size_t FrontSubmap::forget_left_out(const ImageMask& mask) {
  std::vector<int> left_out;
  for (const auto& [id, landmark] : map.landmarks) {
    const auto is_out = [&](const Observation& o) {
      return !mask.allows(map.keyframe(o.keyframe_id)->features->keypoints[o.keypoint_index].pixel);
    };
    const std::vector<Observation>& seen = landmark.observations;
    if (2 * std::count_if(seen.begin(), seen.end(), is_out) > static_cast<std::ptrdiff_t>(seen.size()))
      left_out.push_back(id);
  }
  for (const int id : left_out) map.remove_landmark(id);
  return left_out.size();
}

void FrontSubmap::keypoints_moved(int keyframe_id) {
  grids[keyframe_id] = KeypointGrid(map.keyframe(keyframe_id)->features->undistorted, map.camera);
  moved_.insert(keyframe_id);
}

void FrontSubmap::keep_images(size_t n) {
  while (images.size() > n) {
    const int id = images.begin()->first;
    images.erase(images.begin());
    if (moved_.erase(id) > 0) map.renew_features(id);
    Keyframe& keyframe = *map.keyframe(id);
    keyframe.features = std::make_shared<const Features>(*keyframe.features, &FileMemory::of_process());
  }
}

void FrontSubmap::wake() {
  for (const auto& [id, kf] : map.keyframes)
    if (!grids.contains(id)) grids[id] = KeypointGrid(kf.features->undistorted, map.camera);
}

void FrontSubmap::close() {
  if (map.closed) return;
  map.close();
  keep_images(0);
}

}  // namespace rumi::front_tracker
