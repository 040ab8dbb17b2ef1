// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/past_poses.h"

#include <algorithm>

#include "front_tracker/frame/certainty.h"
#include "front_tracker/matching/projection_search.h"
#include "front_tracker/tracking/found_pose.h"
#include "front_tracker/tracking/local_map.h"

namespace rumi::front_tracker {
namespace {

std::vector<const Landmark*> all_landmarks(const Submap& map) {
  std::vector<const Landmark*> landmarks;
  landmarks.reserve(map.landmarks.size());
  for (const auto& [id, lm] : map.landmarks) landmarks.push_back(&lm);
  return landmarks;
}

}  // namespace

std::vector<Frame> PastPoses::track_back(const Frame& found, std::deque<Frame> frames, FrontSubmap* submap) const {
  constexpr size_t kMost = 60;
  std::vector<Frame> posed;
  Frame next = found;
  while (posed.size() < kMost && !frames.empty()) {
    LocalMap local = local_map(submap->map, next, options_.local_keyframes);
    next.reference_keyframe = local.reference_keyframe;
    for (int id : next.landmark_ids)
      if (id != kNone) local.landmarks.push_back(submap->map.landmark(id));
    Frame frame = std::move(frames.back());
    frames.pop_back();
    if (!track_from(next, local.landmarks, options_.lost_px(), *submap, &frame)) break;
    submap->add_frame(frame);
    posed.push_back(frame);
    next = std::move(frame);
  }
  std::reverse(posed.begin(), posed.end());
  return posed;
}

void PastPoses::fill_in(std::vector<Frame>* frames, std::vector<bool>* posed, FrontSubmap* submap) const {
  const std::vector<const Landmark*> landmarks = all_landmarks(submap->map);
  const auto try_frame = [&](size_t from, size_t to) {
    if (!track_from((*frames)[from], landmarks, options_.uncertain_px, *submap, &(*frames)[to])) return;
    (*posed)[to] = true;
    submap->add_frame((*frames)[to]);
  };
  for (size_t i = frames->size(); i-- > 1;)
    if ((*posed)[i] && !(*posed)[i - 1]) try_frame(i, i - 1);
  for (size_t i = 1; i < frames->size(); ++i)
    if ((*posed)[i - 1] && !(*posed)[i]) try_frame(i - 1, i);
}

PoseCertainty PastPoses::certainty_at(const Frame& posed, const FrontSubmap& submap) const {
  Frame matched = posed;
  if (!track_from(posed, all_landmarks(submap.map), options_.lost_px(), submap, &matched)) return {};
  return matched.certainty;
}

// Tracks the frame from its neighbour's pose. Returns false if it finds few landmarks, or an uncertain pose.
bool PastPoses::track_from(const Frame& neighbour, const std::vector<const Landmark*>& landmarks, double max_image_px,
                           const FrontSubmap& submap, Frame* frame) const {
  const Submap& map = submap.map;
  const ProjectionSearch search{.radius_px = options_.search_radius_px * map.camera.width / 640.0,
                                .max_distance = options_.max_distance};
  frame->clear_matches();
  frame->cam_from_submap = neighbour.cam_from_submap;
  search_by_projection(map.camera, landmarks, search, submap.octave_scales, frame);
  if (refine_pose(map.camera, map, submap.octave_scales, frame) < kFewestLandmarks) return false;
  frame->certainty = certainty_of(map, submap.octave_scales, *frame);
  if (frame->certainty.image_px > max_image_px) return false;
  frame->reference_keyframe = neighbour.reference_keyframe;
  frame->cam_from_keyframe =
      frame->cam_from_submap * map.keyframe(frame->reference_keyframe)->cam_from_submap.inverse();
  return true;
}

}  // namespace rumi::front_tracker
