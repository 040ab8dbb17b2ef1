// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/submap.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace rumi {
namespace {

template <class Map, class Key>
auto* find_in(Map& map, const Key& key) {
  const auto it = map.find(key);
  return it == map.end() ? nullptr : &it->second;
}

}  // namespace

Keyframe* Submap::keyframe(int id) { return find_in(keyframes, id); }
const Keyframe* Submap::keyframe(int id) const { return find_in(keyframes, id); }

void Submap::begin_front_submap(SubmapKey front_key) {
  key = front_key;
  kind = SubmapKind::kFront;
  closed = false;
  revision = 1;
  handed_out_ = 0;
  removed_keyframes = removed_landmarks = {};
  for (auto& [id, kf] : keyframes) kf.revision = kf.created_revision = revision;
  for (auto& [id, lm] : landmarks) lm.revision = revision;
  frames.change_all([this](FramePose* frame) { frame->revision = revision; });
}

void Submap::close() {
  if (closed) return;
  closed = true;
  stamp();
}

Keyframe& Submap::add_keyframe(Keyframe keyframe) {
  keyframe.landmark_ids.assign(keyframe.features->size(), kNone);
  keyframe.revision = keyframe.created_revision = stamp();
  const int id = keyframe.id;
  return keyframes.insert_or_assign(id, std::move(keyframe)).first->second;
}

Landmark& Submap::add_landmark(int id, const Eigen::Vector3d& position) {
  Landmark& lm = landmarks[id];
  lm.id = id;
  lm.position = position;
  touch(lm);
  return lm;
}

void Submap::set_frame(FramePose frame) {
  frame.revision = stamp();
  frames.set(frame);
}

void Submap::move_keyframe(int id, const SE3& cam_from_submap) {
  Keyframe* kf = keyframe(id);
  if (!kf) return;
  kf->cam_from_submap = cam_from_submap;
  touch(*kf);
}

void Submap::move_landmark(int id, const Eigen::Vector3d& position) {
  Landmark* lm = landmark(id);
  if (!lm) return;
  lm->position = position;
  touch(*lm);
}

void Submap::renew_features(int keyframe_id) {
  Keyframe& kf = *keyframe(keyframe_id);
  touch(kf);
  kf.created_revision = kf.revision;
}

bool Submap::add_observation(int landmark_id, int keyframe_id, int keypoint_index) {
  Landmark* lm = landmark(landmark_id);
  Keyframe* kf = keyframe(keyframe_id);
  if (!lm || !kf || keypoint_index < 0 || keypoint_index >= static_cast<int>(kf->landmark_ids.size())) return false;
  const auto at = std::lower_bound(lm->observations.begin(), lm->observations.end(), keyframe_id,
                                   [](const Observation& o, int id) { return o.keyframe_id < id; });
  if (at != lm->observations.end() && at->keyframe_id == keyframe_id) return false;
  const size_t position = at - lm->observations.begin();
  const int previous = kf->landmark_ids[keypoint_index];
  if (previous != kNone) remove_observation(previous, keyframe_id);
  lm->observations.insert(lm->observations.begin() + position, {keyframe_id, keypoint_index});
  lm->is_described = false;
  kf->landmark_ids[keypoint_index] = landmark_id;
  touch(*lm);
  touch(*kf);
  return true;
}

void Submap::remove_observation(int landmark_id, int keyframe_id) {
  Landmark* lm = landmark(landmark_id);
  Keyframe* kf = keyframe(keyframe_id);
  if (!lm) return;
  std::erase_if(lm->observations, [&](const Observation& o) {
    if (o.keyframe_id != keyframe_id) return false;
    if (kf) kf->landmark_ids[o.keypoint_index] = kNone;
    return true;
  });
  lm->is_described = false;
  touch(*lm);
  if (kf) touch(*kf);
}

void Submap::remove_landmark(int id) {
  Landmark* lm = landmark(id);
  if (!lm) return;
  for (const Observation& o : lm->observations) {
    Keyframe* kf = keyframe(o.keyframe_id);
    if (!kf) continue;
    kf->landmark_ids[o.keypoint_index] = kNone;
    touch(*kf);
  }
  landmarks.erase(id);
  removed_landmarks.add(id, stamp());
}

void Submap::remove_keyframe(int id, int heir) {
  Keyframe* kf = keyframe(id);
  const Keyframe* next = keyframe(heir);
  if (!kf || !next || id == heir) return;
  for (int landmark_id : kf->landmark_ids) {
    Landmark* lm = landmark_id == kNone ? nullptr : landmark(landmark_id);
    if (!lm) continue;
    std::erase_if(lm->observations, [id](const Observation& o) { return o.keyframe_id == id; });
    lm->is_described = false;
    touch(*lm);
  }
  const SE3 keyframe_from_heir = kf->cam_from_submap * next->cam_from_submap.inverse();
  std::vector<FramePose> orphans;
  for (const auto& [utime, frame] : frames)
    if (frame.reference_keyframe == id) orphans.push_back(frame);
  for (FramePose& frame : orphans) {
    frame.reference_keyframe = heir;
    frame.cam_from_keyframe = frame.cam_from_keyframe * keyframe_from_heir;
    set_frame(frame);
  }
  keyframes.erase(id);
  removed_keyframes.add(id, stamp());
}

void Submap::remove_frames_from(int64_t utime_us) {
  frames.erase_from(utime_us);
  removed_keyframes.forget(stamp());
  removed_landmarks.forget(stamp());
}

void Submap::fuse_landmarks(int into, int from) {
  const Landmark* source = landmark(from);
  if (!source || !landmark(into) || into == from) return;
  const std::vector<Observation> observations = source->observations;
  remove_landmark(from);
  for (const Observation& o : observations) add_observation(into, o.keyframe_id, o.keypoint_index);
}

SE3 Submap::cam_from_submap(const FramePose& frame) const {
  const Keyframe* kf = keyframe(frame.reference_keyframe);
  if (!kf)
    throw std::logic_error(fmt::format("submap {}: frame {} hangs on keyframe {}, which does not exist", key.id,
                                       frame.utime_us, frame.reference_keyframe));
  return frame.cam_from_keyframe * kf->cam_from_submap;
}

std::vector<std::pair<int, int>> Submap::covisible_keyframes(int keyframe_id) const {
  const Keyframe* kf = keyframe(keyframe_id);
  if (!kf) return {};
  std::vector<int> shared(keyframes.rbegin()->first + 1, 0);
  for (int landmark_id : kf->landmark_ids) {
    const Landmark* lm = landmark_id == kNone ? nullptr : landmark(landmark_id);
    if (!lm) continue;
    for (const Observation& o : lm->observations) ++shared[o.keyframe_id];
  }
  std::vector<std::pair<int, int>> sorted;
  for (int id = 0; id < static_cast<int>(shared.size()); ++id)
    if (id != keyframe_id && shared[id] > 0) sorted.emplace_back(id, shared[id]);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return sorted;
}

}  // namespace rumi
