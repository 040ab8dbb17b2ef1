// SPDX-License-Identifier: BSD-3-Clause
// Writing: only what carries a later revision than the file has.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "map_server/store/blob.h"
#include "map_server/store/map_store.h"

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

std::string MapStore::save(const Atlas& atlas, const std::vector<ImageId>& frames,
                           std::optional<std::chrono::milliseconds> budget) {
  const Deadline deadline = budget ? std::chrono::steady_clock::now() + *budget : Deadline::max();
  try {
    Transaction transaction(db_);
    Rows rows = stored_;
    const bool has_submaps = save_submaps(atlas, deadline, &rows);
    save_frames(atlas, frames);
    save_masks(atlas);
    const bool is_whole = has_submaps && save_placements(atlas, deadline, &rows);
    if (is_whole) {
      save_map(atlas, &rows);
      save_links(atlas, rows);
    }
    const bool is_clean = remove_other_placements(deadline, &rows);
    transaction.commit();
    stored_ = std::move(rows);
    stored_masks_ = atlas.masks();
    if (is_whole) stored_links_ = atlas.links();
    is_behind_ = !is_whole || !is_clean;
    give_back_pages();
    return {};
  } catch (const SqliteError& error) {
    return explain(error);
  }
}

// True when all are written. One is at every call, so that there is an end.
bool MapStore::save_submaps(const Atlas& atlas, Deadline deadline, Rows* rows) {
  bool is_late = false;
  for (const auto& [key, owner] : atlas.submaps()) {
    Stored& stored = (*rows)[key];
    if (owner.submap.revision <= stored.revision) continue;
    if (is_late) return false;
    stored = save_submap(owner, stored);
    is_late = std::chrono::steady_clock::now() >= deadline;
  }
  return true;
}

MapStore::Stored MapStore::save_submap(const AtlasSubmap& owner, const Stored& before) {
  const Submap& s = owner.submap;
  Statement upsert(db_,
                   "INSERT INTO submaps (session, id, kind, closed, revision, camera, levels, scale_factor, stream) "
                   "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) "
                   "ON CONFLICT (session, id) DO UPDATE SET kind = excluded.kind, closed = excluded.closed, "
                   "revision = excluded.revision, camera = excluded.camera, "
                   "levels = excluded.levels, scale_factor = excluded.scale_factor, stream = excluded.stream "
                   "RETURNING submap");
  upsert.bind(s.key.session, s.key.id, static_cast<int>(s.kind), s.closed, s.revision, camera_row(s.camera),
              s.pyramid.levels, s.pyramid.scale_factor, s.stream);
  upsert.step();
  Stored since = before;
  since.row = upsert.integer(0);
  while (upsert.step()) {
  }
  if (!remove_elements(s, since)) since.revision = 0;
  save_keyframes(s, since);
  save_landmarks(s, since);
  save_poses(s, since);
  since.revision = s.revision;
  return since;
}

// False if the submap no longer remembers all that was removed since: then all its elements are gone from the file.
bool MapStore::remove_elements(const Submap& s, const Stored& since) {
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

void MapStore::save_keyframes(const Submap& s, const Stored& since) {
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

void MapStore::save_landmarks(const Submap& s, const Stored& since) {
  Statement insert(db_, "INSERT OR REPLACE INTO landmarks VALUES (?, ?, ?, ?, ?)");
  for (const auto& [id, landmark] : s.landmarks) {
    if (landmark.revision <= since.revision) continue;
    const std::array<double, 3> position{landmark.position.x(), landmark.position.y(), landmark.position.z()};
    insert.bind(since.row, id, as_blob(position), as_blob(landmark.descriptor), landmark.revision).run();
  }
}

void MapStore::save_poses(const Submap& s, const Stored& since) {
  Statement insert(db_, "INSERT OR REPLACE INTO frame_poses VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  for (const auto& [utime_us, frame] : s.frames) {
    if (frame.revision <= since.revision) continue;
    const PoseNumbers pose = pose_numbers(frame.cam_from_keyframe);
    insert
        .bind(since.row, utime_us, frame.reference_keyframe, as_blob(pose), frame.revision,
              or_null(frame.sigmas, frame.sigmas.position), or_null(frame.sigmas, frame.sigmas.rotation_rad),
              or_null(frame.sigmas, frame.sigmas.log_scale))
        .run();
  }
}

void MapStore::save_frames(const Atlas& atlas, const std::vector<ImageId>& frames) {
  Statement insert(db_, "INSERT OR REPLACE INTO frames VALUES (?, ?, ?, ?, ?)");
  for (const ImageId& image : frames) {
    const auto it = atlas.frames().find(image);
    if (it == atlas.frames().end() || it->second.state == TrackingState::kUnknown) continue;
    const FrameRecord& record = it->second;
    insert.bind(image.stream, image.utime_us, record.session, static_cast<int>(record.state), record.submap_id).run();
  }
}

void MapStore::save_masks(const Atlas& atlas) {
  if (atlas.masks() == stored_masks_) return;
  db_.execute("DELETE FROM masks");
  Statement insert(db_, "INSERT INTO masks VALUES (?, ?, ?, ?, ?, ?, ?)");
  for (const auto& [stream, mask] : atlas.masks()) {
    const std::vector<uint8_t> png(mask.png.begin(), mask.png.end());
    insert.bind(stream, mask.session, mask.utime_us, mask.width, mask.height, mask.left_out, as_blob(png)).run();
  }
}

int64_t MapStore::camera_row(const Camera& c) {
  Statement find(
      db_,
      "SELECT camera FROM cameras WHERE model = ? AND width = ? AND height = ? AND fx = ? AND fy = ? AND cx = ? "
      "AND cy = ? AND k1 = ? AND k2 = ? AND p1 = ? AND p2 = ? AND k3 = ? AND k4 = ? AND fps = ?");
  const auto bind = [&c](Statement& s) -> Statement& {
    return s.bind(static_cast<int>(c.model), c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3,
                  c.k4, c.fps);
  };
  if (bind(find).step()) return find.integer(0);
  Statement insert(db_, "INSERT INTO cameras VALUES (NULL, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  bind(insert).run();
  return sqlite3_last_insert_rowid(db_.handle());
}

}  // namespace rumi::map_server
