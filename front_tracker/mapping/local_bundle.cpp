// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/mapping/local_bundle.h"

#include <algorithm>
#include <cmath>

#include "base/running/stage_clock.h"
#include "slam/map/landmark_view.h"

namespace rumi::front_tracker {

LocalBundle::Window LocalBundle::choose_window(const Submap& map, int keyframe_id) const {
  const bool wide = options_.bundle_wide_every > 0 && (keyframe_id + 1) % options_.bundle_wide_every == 0;
  const int most_free = wide ? options_.bundle_wide_keyframes : options_.bundle_keyframes;
  Window window{.newest = keyframe_id,
                .free = {keyframe_id},
                .most_fixed = wide ? options_.bundle_wide_keyframes : options_.bundle_fixed_keyframes};
  for (const auto& [id, shared] : map.covisible_keyframes(keyframe_id)) {
    if (static_cast<int>(window.free.size()) >= most_free) break;
    window.free.insert(id);
  }
  for (int id : window.free)
    for (int lm : map.keyframe(id)->landmark_ids)
      if (lm != kNone) window.landmarks.push_back(lm);
  std::sort(window.landmarks.begin(), window.landmarks.end());
  window.landmarks.erase(std::unique(window.landmarks.begin(), window.landmarks.end()), window.landmarks.end());
  return window;
}

// Returns the keyframes outside the window that see most of its landmarks. As fixed views they hold the window in
// place.
std::vector<int> LocalBundle::choose_fixed(const Submap& map, const Window& window) {
  const int ids = map.keyframes.rbegin()->first + 1;
  std::vector<int> seen(ids, 0);
  for (int id : window.landmarks)
    for (const Observation& o : map.landmark(id)->observations) ++seen[o.keyframe_id];
  std::vector<int> fixed;
  for (int id = 0; id < ids; ++id)
    if (seen[id] > 0 && !window.free.contains(id)) fixed.push_back(id);
  std::stable_sort(fixed.begin(), fixed.end(), [&](int a, int b) { return seen[a] > seen[b]; });
  if (static_cast<int>(fixed.size()) > window.most_fixed) fixed.resize(window.most_fixed);
  return fixed;
}

void LocalBundle::add_views(const Submap& map, const Window& window) {
  const auto add_view = [&](int id, bool fixed) {
    problem_.views.push_back({map.keyframe(id)->cam_from_submap, fixed});
    keyframe_ids_.push_back(id);
  };
  const std::vector<int> fixed = choose_fixed(map, window);
  // At least two views must be fixed, or the window's position or scale would drift. If there are fewer, the oldest
  // free ones are fixed instead; ids are in order of time.
  size_t missing = fixed.size() >= 2 ? 0 : 2 - fixed.size();
  for (int id : window.free) {
    const bool hold = missing > 0 && id != window.newest;
    if (hold) --missing;
    add_view(id, hold);
  }
  for (int id : fixed) add_view(id, true);
}

void LocalBundle::add_points(const FrontSubmap& submap, const std::vector<int>& landmarks) {
  const Submap& map = submap.map;
  std::vector<int> view_of(map.keyframes.rbegin()->first + 1, kNone);
  std::vector<const Features*> features_of;  // by view
  for (int id : keyframe_ids_) {
    view_of[id] = static_cast<int>(features_of.size());
    features_of.push_back(map.keyframe(id)->features.get());
  }
  for (int id : landmarks) {
    const Landmark& lm = *map.landmark(id);
    const int point = static_cast<int>(problem_.points.size());
    problem_.points.push_back(lm.position);
    landmark_ids_.push_back(id);
    for (const Observation& o : lm.observations) {
      const int view = view_of[o.keyframe_id];
      if (view == kNone) continue;
      const Features& features = *features_of[view];
      const BundleProblem::Observation observation{view, point, features.undistorted[o.keypoint_index].cast<double>(),
                                                   submap.octave_scales[features.keypoints[o.keypoint_index].octave],
                                                   features.whitening(o.keypoint_index)};
      // A point behind a camera cannot move in front of it, and the solver would refuse to begin.
      const bool behind = std::isinf(reprojection_chi2(camera_, problem_, observation));
      (behind ? impossible_ : problem_.observations).push_back(observation);
    }
  }
}

void LocalBundle::collect(const FrontSubmap& submap, int keyframe_id) {
  const Window window = choose_window(submap.map, keyframe_id);
  add_views(submap.map, window);
  add_points(submap, window.landmarks);
}

bool LocalBundle::solve() {
  const StageClock clock("front_tracker.adjust");
  return solve_bundle(camera_, {options_.bundle_iterations}, &problem_).usable;
}

void LocalBundle::apply(FrontSubmap& submap) const {
  Submap& map = submap.map;
  for (const BundleProblem::Observation& o : impossible_)
    map.remove_observation(landmark_ids_[o.point], keyframe_ids_[o.view]);
  for (size_t v = 0; v < problem_.views.size(); ++v)
    if (!problem_.views[v].fixed) map.move_keyframe(keyframe_ids_[v], problem_.views[v].cam_from_submap);
  for (size_t p = 0; p < problem_.points.size(); ++p) map.move_landmark(landmark_ids_[p], problem_.points[p]);
  for (const BundleProblem::Observation& o : problem_.observations)
    if (reprojection_chi2(camera_, problem_, o) > 5.991)
      map.remove_observation(landmark_ids_[o.point], keyframe_ids_[o.view]);
  for (int id : landmark_ids_) {
    Landmark* lm = map.landmark(id);
    if (!lm) continue;
    if (lm->observations.size() < 2)
      map.remove_landmark(id);
    else
      update_landmark_view(map, lm);
  }
}

}  // namespace rumi::front_tracker
