// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/submap_writer.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <vector>

#include "map_server/store/blob.h"
#include "map_server/store/cameras_table.h"

namespace rumi::map_server {
namespace {

std::vector<int32_t> observation_pairs(const Keyframe& keyframe) {
  std::vector<int32_t> pairs;
  for (size_t i = 0; i < keyframe.landmark_ids.size(); ++i) {
    if (keyframe.landmark_ids[i] == kNone) continue;
    pairs.push_back(static_cast<int32_t>(i));
    pairs.push_back(keyframe.landmark_ids[i]);
  }
  return pairs;
}

std::optional<double> or_null(const PoseSigmas& sigmas, float value) {
  return sigmas.are_known() ? std::optional(static_cast<double>(value)) : std::nullopt;
}

void insert_features(Statement& insert, int64_t row, const Keyframe& keyframe) {
  std::vector<float> keypoints;
  std::vector<uint8_t> octaves;
  for (const Keypoint& k : keyframe.features->keypoints) {
    keypoints.insert(keypoints.end(), {k.pixel.x(), k.pixel.y(), k.angle_rad});
    octaves.push_back(k.octave);
  }
  insert.bind(row, keyframe.id, as_blob(keypoints), as_blob(octaves), as_blob(keyframe.features->descriptors)).run();
}

}  // namespace

bool SubmapWriter::write(const Atlas& atlas) {
  bool is_late = false;
  for (const auto& [key, owner] : atlas.submaps()) {
    StoredSubmap& stored = (*stored_)[key];
    if (owner.submap.revision <= stored.revision) continue;
    if (is_late) return false;
    stored = write_submap(owner.submap, stored);
    is_late = std::chrono::steady_clock::now() >= deadline_;
  }
  return true;
}

StoredSubmap SubmapWriter::write_submap(const Submap& s, const StoredSubmap& before) {
  Statement upsert(db_,
                   "INSERT INTO submaps (session, id, kind, closed, revision, camera, levels, scale_factor, stream) "
                   "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) "
                   "ON CONFLICT (session, id) DO UPDATE SET kind = excluded.kind, closed = excluded.closed, "
                   "revision = excluded.revision, camera = excluded.camera, "
                   "levels = excluded.levels, scale_factor = excluded.scale_factor, stream = excluded.stream "
                   "RETURNING submap");
  upsert.bind(s.key.session, s.key.id, static_cast<int>(s.kind), s.closed, s.revision, camera_row(s.camera, db_),
              s.pyramid.levels, s.pyramid.scale_factor, s.stream);
  upsert.step();
  StoredSubmap since = before;
  since.row = upsert.integer(0);
  while (upsert.step()) {
  }
  if (!remove_elements(s, since)) since.revision = 0;
  write_keyframes(s, since);
  write_landmarks(s, since);
  write_poses(s, since);
  since.revision = s.revision;
  return since;
}

bool SubmapWriter::remove_elements(const Submap& s, const StoredSubmap& since) {
  const auto keyframes = s.removed_keyframes.since(since.revision);
  const auto landmarks = s.removed_landmarks.since(since.revision);
  if (!keyframes || !landmarks) {
    for (const char* table : {"keyframes", "features", "observations", "landmarks", "frame_poses"})
      Statement(db_, fmt::format("DELETE FROM {} WHERE submap = ?", table)).bind(since.row).run();
    return false;
  }
  for (const char* sql :
       {"DELETE FROM keyframes WHERE submap = ? AND id = ?", "DELETE FROM features WHERE submap = ? AND keyframe = ?",
        "DELETE FROM observations WHERE submap = ? AND keyframe = ?"}) {
    Statement erase(db_, sql);
    for (int id : *keyframes)
      if (!s.keyframe(id)) erase.bind(since.row, id).run();
  }
  Statement erase(db_, "DELETE FROM landmarks WHERE submap = ? AND id = ?");
  for (int id : *landmarks)
    if (!s.landmark(id)) erase.bind(since.row, id).run();
  return true;
}

void SubmapWriter::write_keyframes(const Submap& s, const StoredSubmap& since) {
  Statement insert(db_, "INSERT OR REPLACE INTO keyframes VALUES (?, ?, ?, ?, ?, ?)");
  Statement features(db_, "INSERT OR REPLACE INTO features VALUES (?, ?, ?, ?, ?)");
  Statement observations(db_, "INSERT OR REPLACE INTO observations VALUES (?, ?, ?)");
  for (const auto& [id, keyframe] : s.keyframes) {
    if (keyframe.revision <= since.revision) continue;
    const PoseNumbers pose = pose_numbers(keyframe.cam_from_submap);
    insert.bind(since.row, id, keyframe.utime_us, as_blob(pose), keyframe.revision, keyframe.created_revision).run();
    if (keyframe.created_revision > since.revision) insert_features(features, since.row, keyframe);
    const std::vector<int32_t> pairs = observation_pairs(keyframe);
    observations.bind(since.row, id, as_blob(pairs)).run();
  }
}

void SubmapWriter::write_landmarks(const Submap& s, const StoredSubmap& since) {
  Statement insert(db_, "INSERT OR REPLACE INTO landmarks VALUES (?, ?, ?, ?, ?)");
  for (const auto& [id, landmark] : s.landmarks) {
    if (landmark.revision <= since.revision) continue;
    const std::array<double, 3> position{landmark.position.x(), landmark.position.y(), landmark.position.z()};
    insert.bind(since.row, id, as_blob(position), as_blob(landmark.descriptor), landmark.revision).run();
  }
}

void SubmapWriter::write_poses(const Submap& s, const StoredSubmap& since) {
  Statement insert(db_, "INSERT OR REPLACE INTO frame_poses VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  s.frames.for_each_after(since.revision, [&](const FramePose& frame) {
    const PoseNumbers pose = pose_numbers(frame.cam_from_keyframe);
    insert
        .bind(since.row, frame.utime_us, frame.reference_keyframe, as_blob(pose), frame.revision,
              or_null(frame.sigmas, frame.sigmas.position), or_null(frame.sigmas, frame.sigmas.rotation_rad),
              or_null(frame.sigmas, frame.sigmas.log_scale))
        .run();
  });
}

}  // namespace rumi::map_server
