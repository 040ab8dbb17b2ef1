// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/mapping/local_bundle.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/running/stage_clock.h"
#include "slam/map/landmark_view.h"

namespace rumi::front_tracker {

void LocalBundle::collect(const FrontSubmap& submap, int keyframe_id) {
  const Submap& map = submap.map;
  const bool wide = options_.bundle_wide_every > 0 && (keyframe_id + 1) % options_.bundle_wide_every == 0;
  const int most_free = wide ? options_.bundle_wide_keyframes : options_.bundle_keyframes;
  const int most_fixed = wide ? options_.bundle_wide_keyframes : options_.bundle_fixed_keyframes;
  std::set<int> free{keyframe_id};
  for (const auto& [id, shared] : map.covisible_keyframes(keyframe_id)) {
    if (static_cast<int>(free.size()) >= most_free) break;
    free.insert(id);
  }
  std::vector<int> points;
  for (int id : free)
    for (int lm : map.keyframe(id)->landmark_ids)
      if (lm != kNone) points.push_back(lm);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());

  // Those that see most of the points hold the window in place; at least two, lest position or scale drift.
  const int ids = map.keyframes.rbegin()->first + 1;
  std::vector<int> seen(ids, 0);
  for (int id : points)
    for (const Observation& o : map.landmark(id)->observations) ++seen[o.keyframe_id];
  std::vector<std::pair<int, int>> holding;
  for (int id = 0; id < ids; ++id)
    if (seen[id] > 0 && !free.contains(id)) holding.emplace_back(id, seen[id]);
  std::stable_sort(holding.begin(), holding.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  if (static_cast<int>(holding.size()) > most_fixed) holding.resize(most_fixed);

  std::vector<int> view_of(ids, kNone);
  std::vector<const Features*> features_of;  // by view
  const auto add_view = [&](int id, bool fixed) {
    const Keyframe& kf = *map.keyframe(id);
    view_of[id] = static_cast<int>(problem_.views.size());
    problem_.views.push_back({kf.cam_from_submap, fixed});
    keyframe_ids_.push_back(id);
    features_of.push_back(kf.features.get());
  };
  size_t to_fix = holding.size() >= 2 ? 0 : 2 - holding.size();
  for (int id : free) {
    const bool fixed = to_fix > 0 && id != keyframe_id;  // the oldest, ids being in order of time
    if (fixed) --to_fix;
    add_view(id, fixed);
  }
  for (const auto& [id, count] : holding) add_view(id, true);

  for (int id : points) {
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
      // From behind the camera nothing leads back, and the solver would refuse to begin.
      const bool behind = std::isinf(reprojection_chi2(camera_, problem_, observation));
      (behind ? impossible_ : problem_.observations).push_back(observation);
    }
  }
}

bool LocalBundle::solve() {
  const StageClock clock("front_tracker.adjust");
  return solve_bundle(camera_, {options_.bundle_iterations}, &problem_).usable;
}

void LocalBundle::apply(FrontSubmap& submap) const {
  Submap& map = submap.map;
  for (const BundleProblem::Observation& o : impossible_)
    map.remove_observation(landmark_ids_[o.point], keyframe_ids_[o.view]);
  for (size_t v = 0; v < problem_.views.size(); ++v) {
    Keyframe* kf = map.keyframe(keyframe_ids_[v]);
    if (!kf || problem_.views[v].fixed) continue;
    kf->cam_from_submap = problem_.views[v].cam_from_submap;
    map.touch(*kf);
  }
  for (size_t p = 0; p < problem_.points.size(); ++p) {
    Landmark* lm = map.landmark(landmark_ids_[p]);
    if (!lm) continue;
    lm->position = problem_.points[p];
    map.touch(*lm);
  }
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
