// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/submap_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "base/memory/file_memory.h"
#include "map_server/store/blob.h"
#include "map_server/store/cameras_table.h"
#include "map_server/store/checked_values.h"

namespace rumi::map_server {
namespace {

// Returns the id if it is plausible: vectors are indexed by it, so a huge one would need too much memory.
int checked_keyframe_id(int64_t id) {
  if (id < 0 || id > kMaxKeyframeId) throw std::runtime_error(fmt::format("keyframe {}: ids count up from 0", id));
  return static_cast<int>(id);
}

SE3 checked_pose(std::span<const uint8_t> blob) {
  constexpr double kUnitTolerance = 1e-3;  // largest deviation of a quaternion's length from 1, as for messages
  const SE3 pose = pose_from_numbers(array_from_blob<PoseNumbers>(blob));
  if (!pose.is_finite() || std::abs(pose.rotation.norm() - 1) > kUnitTolerance)
    throw std::runtime_error("a pose is none");
  return pose;
}

Keypoint checked_keypoint(const float* x_y_angle, uint8_t octave, const Submap& submap) {
  const Keypoint keypoint{{x_y_angle[0], x_y_angle[1]}, x_y_angle[2], octave};
  if (octave >= submap.pyramid.levels)
    throw std::runtime_error(fmt::format("keypoint of octave {}, there are {}", octave, submap.pyramid.levels));
  // NaN counts as outside.
  if (!submap.camera.contains(keypoint.pixel.cast<double>(), -1) || !std::isfinite(keypoint.angle_rad))
    throw std::runtime_error(fmt::format("keypoint at {}, {}: not in the image", x_y_angle[0], x_y_angle[1]));
  return keypoint;
}

Pyramid checked_pyramid(int64_t levels, double scale_factor) {
  const Pyramid pyramid{static_cast<int>(std::clamp<int64_t>(levels, 0, Pyramid::kMostLevels + 1)), scale_factor};
  if (!pyramid.is_possible())
    throw std::runtime_error(fmt::format("a pyramid of {} levels, each {} of the last", levels, scale_factor));
  return pyramid;
}

std::shared_ptr<const Features> features_from_row(const Statement& row, int first_column, const Submap& submap) {
  const auto keypoints = vector_from_blob<float>(row.blob(first_column));
  const auto octaves = vector_from_blob<uint8_t>(row.blob(first_column + 1));
  const auto descriptors = vector_from_blob<Descriptor>(row.blob(first_column + 2));
  if (keypoints.size() != octaves.size() * 3 || descriptors.size() != octaves.size())
    throw std::runtime_error("keypoints, octaves and descriptors do not have the same length");
  auto features = std::make_shared<Features>(&FileMemory::of_process());
  features->descriptors.assign(descriptors.begin(), descriptors.end());
  features->keypoints.reserve(octaves.size());
  for (size_t i = 0; i < octaves.size(); ++i)
    features->keypoints.push_back(checked_keypoint(&keypoints[3 * i], octaves[i], submap));
  features->undistort(submap.camera);
  return features;
}

// Keyframes come in order of id, so that the observations of each landmark are in that order too.
void restore_observations(const std::vector<int32_t>& pairs, Keyframe* keyframe, Submap* submap) {
  if (pairs.size() % 2 != 0) throw std::runtime_error("a blob has the wrong size");
  for (size_t i = 0; i < pairs.size(); i += 2) {
    Landmark* landmark = submap->landmark(pairs[i + 1]);
    if (pairs[i] < 0 || pairs[i] >= static_cast<int>(keyframe->landmark_ids.size()) || !landmark)
      throw std::runtime_error(fmt::format("keyframe {} observes what does not exist", keyframe->id));
    const bool again = !landmark->observations.empty() && landmark->observations.back().keyframe_id == keyframe->id;
    if (again || keyframe->landmark_ids[pairs[i]] != kNone)
      throw std::runtime_error(fmt::format("keyframe {} observes twice", keyframe->id));
    keyframe->landmark_ids[pairs[i]] = landmark->id;
    landmark->observations.push_back({keyframe->id, pairs[i]});
  }
}

void read_landmarks(int64_t row, Database& database, Submap* s) {
  Statement landmarks(database,
                      "SELECT id, position, descriptor, revision FROM landmarks WHERE submap = ? ORDER BY id");
  for (landmarks.bind(row); landmarks.step();) {
    Landmark landmark;
    landmark.id = static_cast<int>(landmarks.integer(0));
    const auto position = array_from_blob<std::array<double, 3>>(landmarks.blob(1));
    landmark.position = {position[0], position[1], position[2]};
    if (!landmark.position.allFinite()) throw std::runtime_error(fmt::format("landmark {} is nowhere", landmark.id));
    landmark.descriptor = array_from_blob<Descriptor>(landmarks.blob(2));
    landmark.revision = landmarks.integer(3);
    s->landmarks.emplace(landmark.id, std::move(landmark));
  }
}

void read_keyframes(int64_t row, Database& database, Submap* s) {
  Statement keyframes(database,
                      "SELECT k.id, k.utime, k.cam_from_submap, k.revision, k.created_revision, o.pairs, f.keypoints, "
                      "f.octaves, f.descriptors FROM keyframes k JOIN observations o ON o.submap = k.submap AND "
                      "o.keyframe = k.id JOIN features f ON f.submap = k.submap AND f.keyframe = k.id "
                      "WHERE k.submap = ? ORDER BY k.id");
  for (keyframes.bind(row); keyframes.step();) {
    Keyframe keyframe;
    keyframe.id = checked_keyframe_id(keyframes.integer(0));
    keyframe.utime_us = checked_utime(keyframes.integer(1));
    keyframe.cam_from_submap = checked_pose(keyframes.blob(2));
    keyframe.revision = keyframes.integer(3);
    keyframe.created_revision = keyframes.integer(4);
    keyframe.features = features_from_row(keyframes, 6, *s);
    keyframe.landmark_ids.assign(keyframe.features->keypoints.size(), kNone);
    restore_observations(vector_from_blob<int32_t>(keyframes.blob(5)), &keyframe, s);
    s->keyframes.emplace_hint(s->keyframes.end(), keyframe.id, std::move(keyframe));
  }
}

void read_poses(int64_t row, Database& database, Submap* s) {
  Statement poses(database,
                  "SELECT utime, reference_keyframe, cam_from_keyframe, revision, position_sigma, rotation_sigma_rad, "
                  "log_scale_sigma FROM frame_poses WHERE submap = ?");
  for (poses.bind(row); poses.step();) {
    FramePose pose{checked_utime(poses.integer(0)), static_cast<int>(poses.integer(1)), checked_pose(poses.blob(2)),
                   poses.integer(3),
                   pose_sigmas(poses.real(4), poses.real(5), poses.real(6))};  // 0 stands for NULL: unknown
    if (!s->keyframe(pose.reference_keyframe))
      throw std::runtime_error(fmt::format("frame {} hangs on a keyframe that does not exist", pose.utime_us));
    s->frames.set(pose);
  }
}

void read_elements(int64_t row, Database& database, Submap* s) {
  read_landmarks(row, database, s);
  read_keyframes(row, database, s);
  read_poses(row, database, s);
  // The file does not know which elements were removed earlier.
  s->removed_keyframes.forget(s->revision);
  s->removed_landmarks.forget(s->revision);
}

}  // namespace

SubmapsByRow read_submaps(Database& database, Atlas* atlas, StoredSubmaps* stored) {
  SubmapsByRow keys;
  Statement rows(database,
                 "SELECT submap, session, id, kind, closed, revision, camera, in_map, placement_revision, levels, "
                 "scale_factor, stream FROM submaps");
  while (rows.step()) {
    AtlasSubmap owner;
    Submap& s = owner.submap;
    s.key = {rows.integer(1), static_cast<int32_t>(rows.integer(2))};
    s.kind = checked_enum("a kind of submap", rows.integer(3), SubmapKind::kFront, SubmapKind::kBack);
    s.closed = rows.integer(4) != 0;
    s.revision = rows.integer(5);
    s.camera = read_camera(rows.integer(6), database);
    s.pyramid = checked_pyramid(rows.integer(9), rows.real(10));
    s.stream = rows.integer(11);
    owner.in_map = rows.integer(7) != 0;
    read_elements(rows.integer(0), database, &s);
    (*stored)[s.key] = {.row = rows.integer(0),
                        .revision = s.revision,
                        .in_map = owner.in_map,
                        .placement_revision = rows.integer(8),
                        .written_placement_revision = rows.integer(8)};
    keys[rows.integer(0)] = s.key;
    atlas->restore_submap(std::move(owner));
  }
  return keys;
}

}  // namespace rumi::map_server
