// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/mapping/mapper.h"

#include <algorithm>
#include <set>

#include "base/running/stage_clock.h"
#include "front_tracker/mapping/local_bundle.h"
#include "front_tracker/matching/projection_search.h"
#include "front_tracker/patches/align_keypoints.h"
#include "slam/map/landmark_view.h"

namespace rumi::front_tracker {

Mapper::Mapper(const Camera& camera, const MappingOptions& options) : camera_(camera), options_(options) {}

void Mapper::process(FrontSubmap& submap, int keyframe_id, std::mutex& mutex) const {
  const StageClock clock("front_tracker.map");
  LocalBundle bundle(camera_, options_);
  {
    const std::scoped_lock lock(mutex);
    if (!submap.map.keyframe(keyframe_id)) return;
    cull_landmarks(submap, keyframe_id);
    make_landmarks(submap, keyframe_id);
    fuse_landmarks(submap, keyframe_id);
    bundle.collect(submap, keyframe_id);
  }
  const bool solved = bundle.solve();
  const std::scoped_lock lock(mutex);
  if (solved) bundle.apply(submap);
  cull_keyframes(submap, keyframe_id);
}

// Removes landmarks on probation that are found in less than a quarter of the frames that should see them, or that no
// third keyframe observes soon.
void Mapper::cull_landmarks(FrontSubmap& submap, int keyframe_id) const {
  std::erase_if(submap.recent_landmarks, [&](const std::pair<int, int>& recent) {
    const Landmark* lm = submap.map.landmark(recent.first);
    if (!lm) return true;
    const int age = keyframe_id - recent.second;
    const bool rarely_found = lm->visible >= 8 && 4 * lm->found < lm->visible;
    if (rarely_found || (age >= 2 && lm->observations.size() < 3)) {
      submap.map.remove_landmark(recent.first);
      return true;
    }
    return age >= 3;
  });
}

void Mapper::fuse_landmarks(FrontSubmap& submap, int keyframe_id) const {
  const auto neighbours = submap.map.covisible_keyframes(keyframe_id);
  const size_t n = std::min<size_t>(neighbours.size(), options_.neighbours);
  const auto landmarks_of = [&](int id) {
    std::vector<int> ids;
    for (int lm : submap.map.keyframe(id)->landmark_ids)
      if (lm != kNone) ids.push_back(lm);
    return ids;
  };
  const std::vector<int> own = landmarks_of(keyframe_id);
  std::set<int> theirs;
  for (size_t i = 0; i < n; ++i) {
    fuse_into(submap, own, neighbours[i].first);
    for (int id : landmarks_of(neighbours[i].first)) theirs.insert(id);
  }
  fuse_into(submap, {theirs.begin(), theirs.end()}, keyframe_id);
  for (int id : landmarks_of(keyframe_id)) update_landmark_view(submap.map, submap.map.landmark(id));
}

// Looks for each landmark in the keyframe. A free keypoint becomes an observation of it. If the keypoint has another
// landmark, the two are fused.
void Mapper::fuse_into(FrontSubmap& submap, const std::vector<int>& landmark_ids, int keyframe_id) const {
  Submap& map = submap.map;
  const KeypointGrid& grid = submap.grids[keyframe_id];
  KeyframeAligner aligner(submap, keyframe_id);
  for (int id : landmark_ids) {
    const Landmark* lm = map.landmark(id);
    const Keyframe* kf = map.keyframe(keyframe_id);
    if (!lm || std::any_of(lm->observations.begin(), lm->observations.end(),
                           [&](const Observation& o) { return o.keyframe_id == keyframe_id; }))
      continue;
    const auto at = predict(camera_, kf->cam_from_submap, *lm, submap.octave_scales, 0.5);
    if (!at) continue;
    const float radius = static_cast<float>(3.0 * submap.octave_scales[at->octave]);
    int best = kNone, best_distance = options_.max_distance + 1;
    grid.for_each_near(at->pixel, radius, [&](int i) {
      const int octave = kf->features->keypoints[i].octave;
      if (octave < at->octave - 1 || octave > at->octave + 1) return;
      const double sigma = submap.octave_scales[octave];
      if ((kf->features->undistorted[i] - at->pixel).squaredNorm() > 5.991 * sigma * sigma) return;
      const int distance = hamming_distance(lm->descriptor, kf->features->descriptors[i]);
      if (distance < best_distance) {
        best_distance = distance;
        best = i;
      }
    });
    if (best == kNone) continue;
    const int other = kf->landmark_ids[best];
    if (other == kNone) {
      aligner.align(best, lm->position, lm->observations);
      map.add_observation(id, keyframe_id, best);
    } else if (map.landmark(other)->observations.size() > lm->observations.size()) {
      map.fuse_landmarks(other, id);
    } else {
      map.fuse_landmarks(id, other);
    }
  }
}

// Removes neighbours that are redundant: at least three other keyframes observe nearly all of their landmarks, at about
// as fine an octave or a finer one.
void Mapper::cull_keyframes(FrontSubmap& submap, int keyframe_id) const {
  Submap& map = submap.map;
  if (!map.keyframe(keyframe_id)) return;
  std::vector<const Features*> features_of(map.keyframes.rbegin()->first + 1, nullptr);
  for (const auto& [id, kf] : map.keyframes) features_of[id] = kf.features.get();
  for (const auto& [id, shared] : map.covisible_keyframes(keyframe_id)) {
    // The first keyframe defines the submap's coordinate system; the tracker still uses the newest ones.
    if (id == map.keyframes.begin()->first || id + 2 >= map.keyframes.rbegin()->first) continue;
    const Keyframe& kf = *map.keyframe(id);
    int total = 0, redundant = 0;
    for (size_t i = 0; i < kf.landmark_ids.size(); ++i) {
      const Landmark* lm = kf.landmark_ids[i] == kNone ? nullptr : map.landmark(kf.landmark_ids[i]);
      if (!lm) continue;
      ++total;
      int others = 0;
      for (const Observation& o : lm->observations) {
        if (o.keyframe_id == id) continue;
        const int octave = features_of[o.keyframe_id]->keypoints[o.keypoint_index].octave;
        if (octave <= kf.features->keypoints[i].octave + 1 && ++others >= 3) break;
      }
      redundant += others >= 3;
    }
    if (redundant <= options_.redundant_ratio * total) continue;
    const auto heirs = map.covisible_keyframes(id);
    if (!heirs.empty()) submap.remove_keyframe(id, heirs.front().first);
  }
}

}  // namespace rumi::front_tracker
