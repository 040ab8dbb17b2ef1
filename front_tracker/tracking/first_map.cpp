// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/first_map.h"

#include <algorithm>
#include <numeric>

#include "front_tracker/frame/certainty.h"
#include "slam/map/landmark_view.h"

namespace rumi::front_tracker {
namespace {

// Returns the indices of the views in order of time.
std::vector<size_t> in_time(const std::vector<InitialMap::View>& views) {
  std::vector<size_t> order(views.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return views[a].frame < views[b].frame; });
  return order;
}

// Gives the views their poses, and makes keyframes of some. Returns the keyframe of each view, or kNone. Pyramids are
// made again, because the initializer has kept only the full images.
std::vector<int> add_keyframes(const OrbExtractor& extractor, InitialMap* initial, FrontSubmap* submap) {
  std::vector<int> keyframe_of_view(initial->views.size(), kNone);
  for (const size_t v : in_time(initial->views)) {
    const InitialMap::View& view = initial->views[v];
    Frame& frame = initial->frames[view.frame];
    frame.clear_matches();
    frame.cam_from_submap = view.cam_from_submap;
    if (!view.keyframe) continue;
    if (frame.images)
      frame.images =
          std::make_shared<const ImagePyramid>(extractor.pyramid(frame.images->level(0), frame.images->mask()));
    keyframe_of_view[v] = submap->add_keyframe(&frame).id;
  }
  return keyframe_of_view;
}

void add_landmarks(const std::vector<int>& keyframe_of_view, InitialMap* initial, FrontSubmap* submap) {
  for (const InitialMap::Point& point : initial->points) {
    const int id = submap->add_landmark(point.position).id;
    for (const auto& [view, keypoint] : point.observations) {
      submap->map.add_observation(id, keyframe_of_view[view], keypoint);
      initial->frames[initial->views[view].frame].landmark_ids[keypoint] = id;
    }
    update_landmark_view(submap->map, submap->map.landmark(id));
  }
}

// Adds the views to the submap's frames. Those that are not keyframes refer to the latest keyframe before them.
void add_frames(const std::vector<int>& keyframe_of_view, const PastPoses& past, InitialMap* initial,
                FrontSubmap* submap) {
  int keyframe = kNone;
  for (const size_t v : in_time(initial->views)) {
    Frame& frame = initial->frames[initial->views[v].frame];
    const bool is_keyframe = keyframe_of_view[v] != kNone;
    if (is_keyframe) keyframe = keyframe_of_view[v];
    frame.reference_keyframe = keyframe;
    frame.cam_from_keyframe = frame.cam_from_submap * submap->map.keyframe(keyframe)->cam_from_submap.inverse();
    frame.certainty =
        is_keyframe ? certainty_of(submap->map, submap->octave_scales, frame) : past.certainty_at(frame, *submap);
    submap->add_frame(frame);
  }
}

}  // namespace

std::vector<Frame> add_first_map(InitialMap initial, const OrbExtractor& extractor, const PastPoses& past,
                                 FrontSubmap* submap) {
  const std::vector<int> keyframe_of_view = add_keyframes(extractor, &initial, submap);
  add_landmarks(keyframe_of_view, &initial, submap);
  add_frames(keyframe_of_view, past, &initial, submap);
  std::vector<bool> posed(initial.frames.size(), false);
  for (const InitialMap::View& view : initial.views) posed[view.frame] = true;
  past.fill_in(&initial.frames, &posed, submap);
  std::vector<Frame> frames;
  for (size_t i = 0; i < initial.frames.size(); ++i)
    if (posed[i]) frames.push_back(std::move(initial.frames[i]));
  return frames;
}

}  // namespace rumi::front_tracker
