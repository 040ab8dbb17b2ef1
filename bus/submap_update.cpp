// SPDX-License-Identifier: BSD-3-Clause
#include "bus/submap_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>

#include "bus/camera_file.h"

namespace rumi {
namespace {

// Descriptors travel as they lie in memory.
static_assert(std::endian::native == std::endian::little);

constexpr double kUnitTolerance = 1e-3;       // of a quaternion's length
constexpr double kRoundingTolerance = 1e-12;  // below it a quaternion is left as it is: the round trip keeps every bit

template <class Wire>
void put(const Eigen::Quaterniond& q, const Eigen::Vector3d& t, Wire* wire) {
  for (int i = 0; i < 3; ++i) wire->trans[i] = t[i];
  wire->quat[0] = q.w(), wire->quat[1] = q.x(), wire->quat[2] = q.y(), wire->quat[3] = q.z();
}

template <class Wire, class Transform>
bool take(const Wire& wire, Transform* transform) {
  transform->rotation = Eigen::Quaterniond(wire.quat[0], wire.quat[1], wire.quat[2], wire.quat[3]);
  transform->translation = Eigen::Vector3d(wire.trans[0], wire.trans[1], wire.trans[2]);
  if (!transform->is_finite()) return false;
  const double length = transform->rotation.norm();
  if (std::abs(length - 1.0) > kUnitTolerance) return false;
  if (std::abs(length - 1.0) > kRoundingTolerance) transform->rotation.normalize();
  return true;
}

keyframe_features_t features_to_wire(const Keyframe& keyframe) {
  keyframe_features_t wire;
  wire.keyframe_id = keyframe.id;
  wire.utime = keyframe.utime_us;
  wire.n = static_cast<int32_t>(keyframe.features->keypoints.size());
  for (const Keypoint& keypoint : keyframe.features->keypoints) {
    wire.x.push_back(keypoint.pixel.x());
    wire.y.push_back(keypoint.pixel.y());
    wire.angle.push_back(keypoint.angle_rad);
    wire.octave.push_back(keypoint.octave);
  }
  wire.descriptors.resize(keyframe.features->descriptors.size() * sizeof(Descriptor));
  if (!wire.descriptors.empty())
    std::memcpy(wire.descriptors.data(), keyframe.features->descriptors.data(), wire.descriptors.size());
  wire.descriptor_bytes = static_cast<int32_t>(wire.descriptors.size());
  return wire;
}

std::shared_ptr<const Features> features_from_wire(const keyframe_features_t& wire) {
  auto features = std::make_shared<Features>();
  features->keypoints.resize(wire.n);
  features->descriptors.resize(wire.n);
  for (int i = 0; i < wire.n; ++i) features->keypoints[i] = {{wire.x[i], wire.y[i]}, wire.angle[i], wire.octave[i]};
  if (wire.n > 0) std::memcpy(features->descriptors.data(), wire.descriptors.data(), wire.descriptors.size());
  return features;
}

keyframe_t keyframe_to_wire(const Keyframe& keyframe) {
  keyframe_t wire;
  wire.id = keyframe.id;
  wire.utime = keyframe.utime_us;
  wire.cam_from_submap = to_wire(keyframe.cam_from_submap);
  for (size_t i = 0; i < keyframe.landmark_ids.size(); ++i) {
    if (keyframe.landmark_ids[i] == kNone) continue;
    wire.keypoint_index.push_back(static_cast<int32_t>(i));
    wire.landmark_id.push_back(keyframe.landmark_ids[i]);
  }
  wire.n = static_cast<int32_t>(wire.keypoint_index.size());
  return wire;
}

// Looks at an update without changing anything; problem() says what is wrong with it for this submap.
class Validator {
 public:
  Validator(const submap_update_t& update, const Submap& submap) : update_(update), submap_(submap) {}

  std::string problem() {
    for (const auto& check :
         {&Validator::check_counts, &Validator::check_ids, &Validator::check_features, &Validator::check_keyframes,
          &Validator::check_landmarks, &Validator::check_frames, &Validator::check_removals}) {
      const std::string wrong = (this->*check)();
      if (!wrong.empty()) return wrong;
    }
    return "";
  }

 private:
  static bool fits(int32_t count, size_t size) { return count >= 0 && static_cast<size_t>(count) == size; }

  // Always true for decoded messages; those made in this process may be anything.
  std::string check_counts() {
    const submap_update_t& u = update_;
    const bool ok = fits(u.nfeatures, u.features.size()) && fits(u.nkeyframes, u.keyframes.size()) &&
                    fits(u.nremoved_keyframes, u.removed_keyframes.size()) && fits(u.nlandmarks, u.landmarks.size()) &&
                    fits(u.nremoved_landmarks, u.removed_landmarks.size()) && fits(u.nframes, u.frames.size());
    return ok ? "" : "a count does not fit its array";
  }

  // Fills the sets and refuses negative, repeated and contradictory ids.
  std::string check_ids() {
    const auto take_id = [](const char* what, int32_t id, std::set<int>* into) -> std::string {
      if (id < 0) return fmt::format("{} id {}: must not be negative", what, id);
      return into->insert(id).second ? "" : fmt::format("{} id {}: twice in one update", what, id);
    };
    std::string wrong;
    for (const auto& k : update_.keyframes)
      if (wrong.empty()) wrong = take_id("keyframe", k.id, &keyframes_);
    for (const auto& f : update_.features)
      if (wrong.empty()) wrong = take_id("features of keyframe", f.keyframe_id, &features_);
    for (const auto& l : update_.landmarks)
      if (wrong.empty()) wrong = take_id("landmark", l.id, &landmarks_);
    // Also refused here: an element that is both changed and removed.
    removed_keyframes_ = keyframes_, removed_landmarks_ = landmarks_;
    for (int32_t id : update_.removed_keyframes)
      if (wrong.empty()) wrong = take_id("removed keyframe", id, &removed_keyframes_);
    for (int32_t id : update_.removed_landmarks)
      if (wrong.empty()) wrong = take_id("removed landmark", id, &removed_landmarks_);
    for (int id : keyframes_) removed_keyframes_.erase(id);
    for (int id : landmarks_) removed_landmarks_.erase(id);
    return wrong;
  }

  std::string check_features() {
    for (const keyframe_features_t& f : update_.features) {
      const bool sizes = fits(f.n, f.x.size()) && fits(f.n, f.y.size()) && fits(f.n, f.angle.size()) &&
                         fits(f.n, f.octave.size()) && fits(f.descriptor_bytes, f.descriptors.size()) &&
                         f.descriptors.size() == f.x.size() * sizeof(Descriptor);
      if (!sizes) return fmt::format("features of keyframe {}: the arrays do not have the same length", f.keyframe_id);
      if (!keyframes_.contains(f.keyframe_id))
        return fmt::format("features of keyframe {}: no such keyframe in the update", f.keyframe_id);
      for (int i = 0; i < f.n; ++i)
        if (!std::isfinite(f.x[i]) || !std::isfinite(f.y[i]) || !std::isfinite(f.angle[i]))
          return fmt::format("features of keyframe {}: keypoint {} is not finite", f.keyframe_id, i);
      keypoint_counts_[f.keyframe_id] = f.n;
      utimes_[f.keyframe_id] = f.utime;
    }
    return "";
  }

  std::string check_keyframes() {
    for (const keyframe_t& k : update_.keyframes) {
      const Keyframe* known = submap_.keyframe(k.id);
      if (!known && !features_.contains(k.id)) return fmt::format("keyframe {}: its features are missing", k.id);
      const int64_t utime = features_.contains(k.id) ? utimes_[k.id] : known->utime_us;
      if (k.utime != utime) return fmt::format("keyframe {}: utime {} but its features have {}", k.id, k.utime, utime);
      if (!from_wire(k.cam_from_submap))
        return fmt::format("keyframe {}: cam_from_submap is not a finite rigid transform", k.id);
      const std::string wrong = check_observations(
          k, features_.contains(k.id) ? keypoint_counts_[k.id] : static_cast<int>(known->features->keypoints.size()));
      if (!wrong.empty()) return wrong;
    }
    return "";
  }

  std::string check_observations(const keyframe_t& k, int keypoints) {
    if (!fits(k.n, k.keypoint_index.size()) || !fits(k.n, k.landmark_id.size()))
      return fmt::format("keyframe {}: the observation arrays do not have the same length", k.id);
    std::vector<bool> used(keypoints, false);
    std::set<int> seen;
    for (int i = 0; i < k.n; ++i) {
      const int index = k.keypoint_index[i], landmark = k.landmark_id[i];
      if (index < 0 || index >= keypoints)
        return fmt::format("keyframe {}: observes with keypoint {}, has {}", k.id, index, keypoints);
      if (used[index]) return fmt::format("keyframe {}: keypoint {} observes twice", k.id, index);
      used[index] = true;
      if (!landmark_exists(landmark))
        return fmt::format("keyframe {}: observes landmark {}, which does not exist", k.id, landmark);
      if (!seen.insert(landmark).second) return fmt::format("keyframe {}: observes landmark {} twice", k.id, landmark);
    }
    return "";
  }

  std::string check_landmarks() {
    for (const landmark_t& l : update_.landmarks)
      for (double x : l.position)
        if (!std::isfinite(x)) return fmt::format("landmark {}: position is not finite", l.id);
    return "";
  }

  std::string check_frames() {
    for (const frame_t& f : update_.frames) {
      if (!frames_.insert(f.utime).second) return fmt::format("frame {}: twice in one update", f.utime);
      if (!keyframe_exists(f.reference_keyframe))
        return fmt::format("frame {}: hangs on keyframe {}, which does not exist", f.utime, f.reference_keyframe);
      if (!from_wire(f.cam_from_keyframe))
        return fmt::format("frame {}: cam_from_keyframe is not a finite rigid transform", f.utime);
    }
    return "";
  }

  // Nothing that stays as it was may refer to something that goes.
  std::string check_removals() {
    for (int id : removed_landmarks_) {
      const Landmark* landmark = submap_.landmark(id);
      if (!landmark) continue;
      for (const Observation& o : landmark->observations)
        if (!keyframes_.contains(o.keyframe_id) && !removed_keyframes_.contains(o.keyframe_id))
          return fmt::format("removed landmark {}: keyframe {} still observes it", id, o.keyframe_id);
    }
    if (removed_keyframes_.empty()) return "";
    for (const auto& [utime, frame] : submap_.frames)
      if (removed_keyframes_.contains(frame.reference_keyframe) && !frames_.contains(utime))
        return fmt::format("removed keyframe {}: frame {} still hangs on it", frame.reference_keyframe, utime);
    return "";
  }

  bool keyframe_exists(int id) const {
    return keyframes_.contains(id) || (submap_.keyframe(id) && !removed_keyframes_.contains(id));
  }
  bool landmark_exists(int id) const {
    return landmarks_.contains(id) || (submap_.landmark(id) && !removed_landmarks_.contains(id));
  }

  const submap_update_t& update_;
  const Submap& submap_;
  std::set<int> keyframes_, features_, landmarks_, removed_keyframes_, removed_landmarks_;
  std::set<int64_t> frames_;
  std::map<int, int> keypoint_counts_;
  std::map<int, int64_t> utimes_;
};

std::string check_header(const submap_update_t& update, const Submap& submap) {
  const SubmapKey key{update.session, update.submap_id};
  if (submap.key != SubmapKey{} && submap.key != key)
    return fmt::format("is of session {} submap {}, not of session {} submap {}", key.session, key.id,
                       submap.key.session, submap.key.id);
  const bool front = update.kind == submap_update_t::FRONT;
  if (!front && update.kind != submap_update_t::BACK)
    return fmt::format("kind {}: must be 0 (front) or 1 (back)", update.kind);
  if (front ? update.submap_id <= 0 : update.submap_id >= 0)
    return fmt::format("submap_id {}: front submaps count 1, 2, ..., back submaps -1, -2, ...", update.submap_id);
  if (update.base_revision < 0 || update.revision < update.base_revision)
    return fmt::format("revision {} must not be below base_revision {}, nor that negative", update.revision,
                       update.base_revision);
  if (update.base_revision > submap.revision)
    return fmt::format("base_revision {} is beyond revision {}, the one we have", update.base_revision,
                       submap.revision);
  return "";
}

void forget_observations(const Keyframe& keyframe, Submap* submap) {
  for (int landmark_id : keyframe.landmark_ids) {
    Landmark* landmark = landmark_id == kNone ? nullptr : submap->landmark(landmark_id);
    if (landmark)
      std::erase_if(landmark->observations, [&](const Observation& o) { return o.keyframe_id == keyframe.id; });
  }
}

void apply_removals(const submap_update_t& update, Submap* s) {
  for (const keyframe_t& k : update.keyframes)
    if (const Keyframe* known = s->keyframe(k.id)) forget_observations(*known, s);
  for (int32_t id : update.removed_keyframes) {
    if (const Keyframe* known = s->keyframe(id)) forget_observations(*known, s);
    s->keyframes.erase(id);
    s->removed_keyframes[id] = update.revision;
  }
  for (int32_t id : update.removed_landmarks) {
    s->landmarks.erase(id);
    s->removed_landmarks[id] = update.revision;
  }
}

void apply_landmarks(const submap_update_t& update, Submap* s) {
  for (const landmark_t& l : update.landmarks) {
    Landmark& landmark = s->landmarks[l.id];
    landmark.id = l.id;
    landmark.position = Eigen::Vector3d(l.position[0], l.position[1], l.position[2]);
    std::memcpy(landmark.descriptor.data(), l.descriptor, sizeof(Descriptor));
    landmark.revision = update.revision;
    s->removed_landmarks.erase(l.id);
  }
}

void apply_keyframes(const submap_update_t& update, Submap* s) {
  for (const keyframe_features_t& f : update.features) {
    Keyframe& keyframe = s->keyframes[f.keyframe_id];
    keyframe.features = features_from_wire(f);
    keyframe.created_revision = update.revision;
  }
  for (const keyframe_t& k : update.keyframes) {
    Keyframe& keyframe = s->keyframes[k.id];
    keyframe.id = k.id;
    keyframe.utime_us = k.utime;
    keyframe.cam_from_submap = *from_wire(k.cam_from_submap);
    keyframe.revision = update.revision;
    keyframe.landmark_ids.assign(keyframe.features->keypoints.size(), kNone);
    s->removed_keyframes.erase(k.id);
    for (int i = 0; i < k.n; ++i) {
      keyframe.landmark_ids[k.keypoint_index[i]] = k.landmark_id[i];
      std::vector<Observation>& observations = s->landmark(k.landmark_id[i])->observations;
      const auto at = std::lower_bound(observations.begin(), observations.end(), k.id,
                                       [](const Observation& o, int id) { return o.keyframe_id < id; });
      observations.insert(at, {k.id, k.keypoint_index[i]});
    }
  }
}

}  // namespace

submap_update_t make_submap_update(const Submap& submap, int64_t base_revision) {
  submap_update_t u;
  u.session = submap.key.session;
  u.submap_id = submap.key.id;
  u.kind = static_cast<int8_t>(submap.kind);
  u.closed = submap.closed;
  u.base_revision = base_revision;
  u.revision = submap.revision;
  u.calibration = camera_to_yaml(submap.camera);
  for (const auto& [id, keyframe] : submap.keyframes) {
    if (keyframe.created_revision > base_revision) u.features.push_back(features_to_wire(keyframe));
    if (keyframe.revision > base_revision) u.keyframes.push_back(keyframe_to_wire(keyframe));
  }
  for (const auto& [id, landmark] : submap.landmarks) {
    if (landmark.revision <= base_revision) continue;
    landmark_t& wire = u.landmarks.emplace_back();
    wire.id = id;
    std::copy_n(landmark.position.data(), 3, wire.position);
    std::memcpy(wire.descriptor, landmark.descriptor.data(), sizeof(Descriptor));
  }
  for (const auto& [utime, frame] : submap.frames) {
    if (frame.revision <= base_revision) continue;
    frame_t& wire = u.frames.emplace_back();
    wire.utime = utime;
    wire.reference_keyframe = frame.reference_keyframe;
    wire.cam_from_keyframe = to_wire(frame.cam_from_keyframe);
  }
  for (const auto& [id, revision] : submap.removed_keyframes)
    if (revision > base_revision && !submap.keyframe(id)) u.removed_keyframes.push_back(id);
  for (const auto& [id, revision] : submap.removed_landmarks)
    if (revision > base_revision && !submap.landmark(id)) u.removed_landmarks.push_back(id);
  u.nfeatures = static_cast<int32_t>(u.features.size());
  u.nkeyframes = static_cast<int32_t>(u.keyframes.size());
  u.nremoved_keyframes = static_cast<int32_t>(u.removed_keyframes.size());
  u.nlandmarks = static_cast<int32_t>(u.landmarks.size());
  u.nremoved_landmarks = static_cast<int32_t>(u.removed_landmarks.size());
  u.nframes = static_cast<int32_t>(u.frames.size());
  return u;
}

std::string apply_submap_update(const submap_update_t& update, Submap* submap) {
  std::string wrong = check_header(update, *submap);
  if (wrong.empty() && update.revision <= submap->revision) return "";
  CameraFileResult calibration;
  if (wrong.empty()) wrong = Validator(update, *submap).problem();
  if (wrong.empty()) {
    calibration = parse_camera(update.calibration, "calibration");
    wrong = calibration.error;
  }
  if (!wrong.empty()) return fmt::format("update of submap {}: {}", update.submap_id, wrong);

  submap->key = {update.session, update.submap_id};
  submap->kind = static_cast<SubmapKind>(update.kind);
  submap->camera = calibration.camera;
  submap->closed = update.closed;
  submap->revision = update.revision;
  apply_removals(update, submap);
  apply_landmarks(update, submap);
  apply_keyframes(update, submap);
  for (const frame_t& f : update.frames)
    submap->frames[f.utime] = {f.utime, f.reference_keyframe, *from_wire(f.cam_from_keyframe), update.revision};
  return "";
}

rigid_t to_wire(const SE3& pose) {
  rigid_t wire;
  put(pose.rotation, pose.translation, &wire);
  return wire;
}

similarity_t to_wire(const Sim3& similarity) {
  similarity_t wire;
  wire.scale = similarity.scale;
  put(similarity.rotation, similarity.translation, &wire);
  return wire;
}

rigid_transform_t to_wire(int64_t utime, const SE3& pose) {
  rigid_transform_t wire;
  wire.utime = utime;
  put(pose.rotation, pose.translation, &wire);
  return wire;
}

std::optional<SE3> from_wire(const rigid_t& pose) {
  SE3 result;
  if (!take(pose, &result)) return std::nullopt;
  return result;
}

std::optional<Sim3> from_wire(const similarity_t& similarity) {
  Sim3 result;
  result.scale = similarity.scale;
  if (!take(similarity, &result) || similarity.scale <= 0) return std::nullopt;
  return result;
}

}  // namespace rumi
