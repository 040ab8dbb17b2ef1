// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/submap_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "base/memory/file_memory.h"
#include "bus/wire/calibration.h"
#include "bus/wire/pose.h"
#include "bus/wire/submap_update_check.h"

namespace rumi {
namespace {

// Descriptors travel byte by byte, as they are in memory.
static_assert(std::endian::native == std::endian::little);

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

std::shared_ptr<const Features> features_from_wire(const keyframe_features_t& wire, const Camera& camera) {
  auto features = std::make_shared<Features>(&FileMemory::of_process());
  features->keypoints.resize(wire.n);
  features->descriptors.resize(wire.n);
  for (int i = 0; i < wire.n; ++i) features->keypoints[i] = {{wire.x[i], wire.y[i]}, wire.angle[i], wire.octave[i]};
  if (wire.n > 0) std::memcpy(features->descriptors.data(), wire.descriptors.data(), wire.descriptors.size());
  features->undistort(camera);
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

// Empties the submap for an update that holds all of it. Such an update does not list the elements that were removed
// earlier, so removals before `revision` are forgotten.
void start_over(int64_t revision, Submap* s) {
  *s = Submap();
  s->removed_keyframes.forget(revision);
  s->removed_landmarks.forget(revision);
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
    s->removed_keyframes.add(id, update.revision);
  }
  for (int32_t id : update.removed_landmarks) {
    s->landmarks.erase(id);
    s->removed_landmarks.add(id, update.revision);
  }
}

void apply_landmarks(const submap_update_t& update, Submap* s) {
  for (const landmark_t& l : update.landmarks) {
    Landmark& landmark = s->landmarks[l.id];
    landmark.id = l.id;
    landmark.position = Eigen::Vector3d(l.position[0], l.position[1], l.position[2]);
    std::memcpy(landmark.descriptor.data(), l.descriptor, sizeof(Descriptor));
    landmark.revision = update.revision;
  }
}

void apply_keyframes(const submap_update_t& update, Submap* s) {
  for (const keyframe_features_t& f : update.features) {
    Keyframe& keyframe = s->keyframes[f.keyframe_id];
    keyframe.features = features_from_wire(f, s->camera);
    keyframe.created_revision = update.revision;
  }
  for (const keyframe_t& k : update.keyframes) {
    Keyframe& keyframe = s->keyframes[k.id];
    keyframe.id = k.id;
    keyframe.utime_us = k.utime;
    keyframe.cam_from_submap = *from_wire(k.cam_from_submap);
    keyframe.revision = update.revision;
    keyframe.landmark_ids.assign(keyframe.features->keypoints.size(), kNone);
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
  std::optional<std::vector<int>> removed_keyframes = submap.removed_keyframes.since(base_revision);
  std::optional<std::vector<int>> removed_landmarks = submap.removed_landmarks.since(base_revision);
  if (base_revision == 0 || !removed_keyframes || !removed_landmarks) {
    base_revision = 0;
    removed_keyframes = removed_landmarks = std::vector<int>();
  }
  submap_update_t u;
  u.session = submap.key.session;
  u.submap_id = submap.key.id;
  u.kind = static_cast<int8_t>(submap.kind);
  u.closed = submap.closed;
  u.base_revision = base_revision;
  u.revision = submap.revision;
  u.stream = submap.stream;
  u.calibration = camera_to_yaml(submap.camera);
  u.levels = static_cast<int8_t>(submap.pyramid.levels);
  u.scale_factor = submap.pyramid.scale_factor;
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
  submap.frames.for_each_after(base_revision, [&u](const FramePose& frame) {
    frame_t& wire = u.frames.emplace_back();
    wire.utime = frame.utime_us;
    wire.reference_keyframe = frame.reference_keyframe;
    wire.cam_from_keyframe = to_wire(frame.cam_from_keyframe);
    put_sigmas(frame.sigmas, &wire);
  });
  for (int id : *removed_keyframes)
    if (!submap.keyframe(id)) u.removed_keyframes.push_back(id);
  for (int id : *removed_landmarks)
    if (!submap.landmark(id)) u.removed_landmarks.push_back(id);
  u.nfeatures = static_cast<int32_t>(u.features.size());
  u.nkeyframes = static_cast<int32_t>(u.keyframes.size());
  u.nremoved_keyframes = static_cast<int32_t>(u.removed_keyframes.size());
  u.nlandmarks = static_cast<int32_t>(u.landmarks.size());
  u.nremoved_landmarks = static_cast<int32_t>(u.removed_landmarks.size());
  u.nframes = static_cast<int32_t>(u.frames.size());
  return u;
}

Result<> apply_submap_update(const submap_update_t& update, Submap* submap) {
  const auto refuse = [&update](const std::string& why) {
    return Error{fmt::format("update of submap {}: {}", update.submap_id, why)};
  };
  if (const Result<> header = check_update_header(update, *submap); !header) return refuse(header.error_text());
  if (update.revision <= submap->revision) return {};
  const Result<Calibration> calibration = parse_calibration(update.calibration, "calibration");
  if (!calibration) return refuse(calibration.error_text());
  const bool is_whole = update.base_revision == 0;
  if (!is_whole && camera_to_yaml(calibration->camera) != camera_to_yaml(submap->camera))
    return refuse("its calibration is not that of the submap");
  const Submap nothing;
  const Result<> elements =
      check_update_elements(update, calibration->camera, is_whole ? nothing : std::as_const(*submap));
  if (!elements) return refuse(elements.error_text());
  if (is_whole) start_over(update.revision, submap);
  submap->key = {update.session, update.submap_id};
  submap->kind = static_cast<SubmapKind>(update.kind);
  submap->camera = calibration->camera;
  submap->stream = update.stream;
  submap->pyramid = {update.levels, update.scale_factor};
  submap->closed = update.closed;
  submap->revision = update.revision;
  apply_removals(update, submap);
  apply_landmarks(update, submap);
  apply_keyframes(update, submap);
  for (const frame_t& f : update.frames)
    submap->frames.set({f.utime, f.reference_keyframe, *from_wire(f.cam_from_keyframe), update.revision, sigmas_of(f)});
  return {};
}

}  // namespace rumi
