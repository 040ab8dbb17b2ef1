// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/submap_update_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "bus/transport/bus.h"
#include "bus/wire/pose.h"

namespace rumi {
namespace {

class IdSet {
 public:
  // Returns false if the set already holds the id.
  bool insert(int id) {
    if (has_.size() <= static_cast<size_t>(id)) has_.resize(std::max<size_t>(id + 1, 2 * has_.size()));
    const bool is_new = !has_[id];
    has_[id] = true;
    return is_new;
  }
  bool contains(int id) const { return id >= 0 && static_cast<size_t>(id) < has_.size() && has_[id]; }

 private:
  std::vector<bool> has_;
};

class Validator {
 public:
  Validator(const submap_update_t& update, const Camera& camera, const Submap& submap)
      : update_(update), camera_(camera), submap_(submap) {}

  Result<> check() {
    for (const auto& check :
         {&Validator::check_counts, &Validator::check_ids, &Validator::check_features, &Validator::check_keyframes,
          &Validator::check_landmarks, &Validator::check_frames, &Validator::check_removals}) {
      if (const Result<> checked = (this->*check)(); !checked) return checked;
    }
    return {};
  }

 private:
  static bool fits(int32_t count, size_t size) { return count >= 0 && static_cast<size_t>(count) == size; }

  // Decoded messages always pass; messages made in this process may hold any counts.
  Result<> check_counts() {
    const submap_update_t& u = update_;
    const bool ok = fits(u.nfeatures, u.features.size()) && fits(u.nkeyframes, u.keyframes.size()) &&
                    fits(u.nremoved_keyframes, u.removed_keyframes.size()) && fits(u.nlandmarks, u.landmarks.size()) &&
                    fits(u.nremoved_landmarks, u.removed_landmarks.size()) && fits(u.nframes, u.frames.size());
    if (!ok) return Error{"a count does not fit its array"};
    return {};
  }

  // Fills the sets and refuses negative, repeated and contradictory ids.
  Result<> check_ids() {
    const auto take_id = [](const char* what, int32_t id, int most, IdSet* into) -> Result<> {
      if (id < 0) return Error{fmt::format("{} id {}: must not be negative", what, id)};
      if (id > most) return Error{fmt::format("{} id {}: ids count up from 0, {} at most", what, id, most)};
      if (!into->insert(id)) return Error{fmt::format("{} id {}: twice in one update", what, id)};
      return {};
    };
    // Refuses also an element that is both changed and removed.
    const auto take_removed = [&](const char* what, int32_t id, int most, const IdSet& changed,
                                  IdSet* into) -> Result<> {
      if (changed.contains(id)) return Error{fmt::format("{} id {}: twice in one update", what, id)};
      return take_id(what, id, most, into);
    };
    constexpr int kMost = kMaxKeyframeId, kMostLandmarks = IdMap<Landmark>::kMaxId;
    Result<> ids;
    for (const auto& k : update_.keyframes)
      if (ids) ids = take_id("keyframe", k.id, kMost, &keyframes_);
    for (const auto& f : update_.features)
      if (ids) ids = take_id("features of keyframe", f.keyframe_id, kMost, &features_);
    for (const auto& l : update_.landmarks)
      if (ids) ids = take_id("landmark", l.id, kMostLandmarks, &landmarks_);
    for (int32_t id : update_.removed_keyframes)
      if (ids) ids = take_removed("removed keyframe", id, kMost, keyframes_, &removed_keyframes_);
    for (int32_t id : update_.removed_landmarks)
      if (ids) ids = take_removed("removed landmark", id, kMostLandmarks, landmarks_, &removed_landmarks_);
    return ids;
  }

  Result<> check_features() {
    for (const keyframe_features_t& f : update_.features) {
      const bool sizes = fits(f.n, f.x.size()) && fits(f.n, f.y.size()) && fits(f.n, f.angle.size()) &&
                         fits(f.n, f.octave.size()) && fits(f.descriptor_bytes, f.descriptors.size()) &&
                         f.descriptors.size() == f.x.size() * sizeof(Descriptor);
      if (!sizes)
        return Error{fmt::format("features of keyframe {}: the arrays do not have the same length", f.keyframe_id)};
      if (!keyframes_.contains(f.keyframe_id))
        return Error{fmt::format("features of keyframe {}: no such keyframe in the update", f.keyframe_id)};
      if (const Result<> keypoints = check_keypoints(f); !keypoints)
        return Error{fmt::format("features of keyframe {}: {}", f.keyframe_id, keypoints.error_text())};
      new_features_[f.keyframe_id] = &f;
    }
    return {};
  }

  Result<> check_keypoints(const keyframe_features_t& f) const {
    for (int i = 0; i < f.n; ++i) {
      if (!std::isfinite(f.x[i]) || !std::isfinite(f.y[i]) || !std::isfinite(f.angle[i]))
        return Error{fmt::format("keypoint {} is not finite", i)};
      if (f.octave[i] >= update_.levels)
        return Error{fmt::format("keypoint {} is of octave {}, there are {}", i, f.octave[i], update_.levels)};
      if (!camera_.contains(Eigen::Vector2d(f.x[i], f.y[i]), -1))
        return Error{fmt::format("keypoint {} at {}, {} is outside the image", i, f.x[i], f.y[i])};
    }
    return {};
  }

  Result<> check_keyframes() {
    for (const keyframe_t& k : update_.keyframes) {
      const Keyframe* known = submap_.keyframe(k.id);
      const auto added = new_features_.find(k.id);
      const bool is_added = added != new_features_.end();
      if (!known && !is_added) return Error{fmt::format("keyframe {}: its features are missing", k.id)};
      const int64_t utime = is_added ? added->second->utime : known->utime_us;
      const int keypoints = is_added ? added->second->n : static_cast<int>(known->features->keypoints.size());
      if (k.utime != utime)
        return Error{fmt::format("keyframe {}: utime {} but its features have {}", k.id, k.utime, utime)};
      if (!from_wire(k.cam_from_submap))
        return Error{fmt::format("keyframe {}: cam_from_submap is not a finite rigid transform", k.id)};
      if (const Result<> observations = check_observations(k, keypoints); !observations) return observations;
    }
    return {};
  }

  Result<> check_observations(const keyframe_t& k, int keypoints) {
    if (!fits(k.n, k.keypoint_index.size()) || !fits(k.n, k.landmark_id.size()))
      return Error{fmt::format("keyframe {}: the observation arrays do not have the same length", k.id)};
    std::vector<bool> used(keypoints, false);
    for (int i = 0; i < k.n; ++i) {
      const int index = k.keypoint_index[i], landmark = k.landmark_id[i];
      if (index < 0 || index >= keypoints)
        return Error{fmt::format("keyframe {}: observes with keypoint {}, has {}", k.id, index, keypoints)};
      if (used[index]) return Error{fmt::format("keyframe {}: keypoint {} observes twice", k.id, index)};
      used[index] = true;
      if (!landmark_exists(landmark))
        return Error{fmt::format("keyframe {}: observes landmark {}, which does not exist", k.id, landmark)};
    }
    std::vector<int> seen = k.landmark_id;
    std::sort(seen.begin(), seen.end());
    const auto twice = std::adjacent_find(seen.begin(), seen.end());
    if (twice != seen.end()) return Error{fmt::format("keyframe {}: observes landmark {} twice", k.id, *twice)};
    return {};
  }

  Result<> check_landmarks() {
    for (const landmark_t& l : update_.landmarks)
      for (double x : l.position)
        if (!std::isfinite(x)) return Error{fmt::format("landmark {}: position is not finite", l.id)};
    return {};
  }

  Result<> check_frames() {
    for (const frame_t& f : update_.frames) {
      if (!plausible_utime(f.utime)) return Error{fmt::format("frame {}: its utime is no time", f.utime)};
      if (!frames_.insert(f.utime).second) return Error{fmt::format("frame {}: twice in one update", f.utime)};
      if (!keyframe_exists(f.reference_keyframe))
        return Error{
            fmt::format("frame {}: hangs on keyframe {}, which does not exist", f.utime, f.reference_keyframe)};
      if (!from_wire(f.cam_from_keyframe))
        return Error{fmt::format("frame {}: cam_from_keyframe is not a finite rigid transform", f.utime)};
    }
    return {};
  }

  // Refuses the removal of an element to which an unchanged element refers.
  Result<> check_removals() {
    for (int id : update_.removed_landmarks) {
      const Landmark* landmark = submap_.landmark(id);
      if (!landmark) continue;
      for (const Observation& o : landmark->observations)
        if (!keyframes_.contains(o.keyframe_id) && !removed_keyframes_.contains(o.keyframe_id))
          return Error{fmt::format("removed landmark {}: keyframe {} still observes it", id, o.keyframe_id)};
    }
    if (update_.removed_keyframes.empty()) return {};
    for (const auto& [utime, frame] : submap_.frames)
      if (removed_keyframes_.contains(frame.reference_keyframe) && !frames_.contains(utime))
        return Error{fmt::format("removed keyframe {}: frame {} still hangs on it", frame.reference_keyframe, utime)};
    return {};
  }

  bool keyframe_exists(int id) const {
    return keyframes_.contains(id) || (submap_.keyframe(id) && !removed_keyframes_.contains(id));
  }
  bool landmark_exists(int id) const {
    return landmarks_.contains(id) || (submap_.landmark(id) && !removed_landmarks_.contains(id));
  }

  const submap_update_t& update_;
  const Camera& camera_;
  const Submap& submap_;
  IdSet keyframes_, features_, landmarks_, removed_keyframes_, removed_landmarks_;
  std::set<int64_t> frames_;
  std::map<int, const keyframe_features_t*> new_features_;
};

}  // namespace

Result<> check_update_header(const submap_update_t& update, const Submap& submap) {
  const SubmapKey key{update.session, update.submap_id};
  if (submap.key != SubmapKey{} && submap.key != key)
    return Error{fmt::format("is of session {} submap {}, not of session {} submap {}", key.session, key.id,
                             submap.key.session, submap.key.id)};
  const bool front = update.kind == submap_update_t::FRONT;
  if (!front && update.kind != submap_update_t::BACK)
    return Error{fmt::format("kind {}: must be 0 (front) or 1 (back)", update.kind)};
  if (front ? update.submap_id <= 0 : update.submap_id >= 0)
    return Error{
        fmt::format("submap_id {}: front submaps count 1, 2, ..., back submaps -1, -2, ...", update.submap_id)};
  if (update.base_revision < 0 || update.revision < update.base_revision)
    return Error{fmt::format("revision {} must not be below base_revision {}, nor that negative", update.revision,
                             update.base_revision)};
  if (update.base_revision > submap.revision)
    return Error{
        fmt::format("base_revision {} is beyond revision {}, the one we have", update.base_revision, submap.revision)};
  const Pyramid pyramid{update.levels, update.scale_factor};
  if (!pyramid.is_possible())
    return Error{fmt::format("levels {}, scale_factor {}: must be 1 to {}, and {} to {}", update.levels,
                             update.scale_factor, Pyramid::kMostLevels, Pyramid::kLeastFactor, Pyramid::kMostFactor)};
  if (update.base_revision > 0 && update.stream != submap.stream)
    return Error{fmt::format("stream {}: the submap is of stream {}", update.stream, submap.stream)};
  if (update.base_revision > 0 && pyramid != submap.pyramid)
    return Error{fmt::format("levels {}, scale_factor {}: the submap has {}, {}", update.levels, update.scale_factor,
                             submap.pyramid.levels, submap.pyramid.scale_factor)};
  return {};
}

Result<> check_update_elements(const submap_update_t& update, const Camera& camera, const Submap& submap) {
  return Validator(update, camera, submap).check();
}

}  // namespace rumi
