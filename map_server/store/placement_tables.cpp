// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/placement_tables.h"

#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "map_server/store/blob.h"
#include "map_server/store/submap_values.h"

namespace rumi::map_server {
namespace {

constexpr const char* kTables[] = {"placed_keyframes", "placed_landmarks", "fused_landmarks"};

// Returns the query for the valid placements, and for placements of submaps that are missing.
std::string select_placed(const std::string& columns, const std::string& table) {
  return fmt::format(
      "SELECT p.submap, {} FROM {} p LEFT JOIN submaps s ON s.submap = p.submap "
      "WHERE p.revision IS coalesce(s.placement_revision, p.revision)",
      columns, table);
}

}  // namespace

bool PlacementWriter::write(const Atlas& atlas) {
  bool is_late = false;
  for (const auto& [key, owner] : atlas.submaps()) {
    StoredSubmap& stored = stored_->at(key);
    if (stored.written_placement_revision == owner.placement.revision) continue;
    if (is_late) return false;
    write_placement(owner.placement, stored.row);
    stored.written_placement_revision = owner.placement.revision;
    stored.may_have_others = true;
    is_late = std::chrono::steady_clock::now() >= deadline_;
  }
  return true;
}

void PlacementWriter::write_placement(const Placement& placement, int64_t row) {
  // If a process died while it wrote, there may be old rows of the revision that is now written again.
  for (const char* table : kTables)
    Statement(db_, fmt::format("DELETE FROM {} WHERE submap = ? AND revision = ?", table))
        .bind(row, placement.revision)
        .run();
  Statement keyframe(db_, "INSERT INTO placed_keyframes VALUES (?, ?, ?, ?)");
  for (const auto& [utime_us, map_from_submap] : placement.map_from_submap) {
    const SimilarityNumbers numbers = similarity_numbers(map_from_submap);
    keyframe.bind(row, placement.revision, utime_us, as_blob(numbers)).run();
  }
  Statement landmark(db_, "INSERT INTO placed_landmarks VALUES (?, ?, ?, ?)");
  for (const auto& [id, position] : placement.landmarks) {
    const std::array<double, 3> numbers{position.x(), position.y(), position.z()};
    landmark.bind(row, placement.revision, id, as_blob(numbers)).run();
  }
  Statement fused(db_, "INSERT INTO fused_landmarks VALUES (?, ?, ?, ?, ?)");
  for (const auto& [id, into] : placement.fused)
    fused.bind(row, placement.revision, id, stored_->at(into.submap).row, into.id).run();
}

void PlacementWriter::make_valid(const Atlas& atlas) {
  Statement(db_, "UPDATE atlas SET map_revision = ?1 WHERE map_revision <> ?1").bind(atlas.revision()).run();
  Statement update(db_, "UPDATE submaps SET in_map = ?, placement_revision = ? WHERE submap = ?");
  for (const auto& [key, owner] : atlas.submaps()) {
    StoredSubmap& stored = stored_->at(key);
    const int64_t revision = owner.placement.revision;
    if (owner.in_map == stored.in_map && revision == stored.placement_revision) continue;
    update.bind(owner.in_map, revision, stored.row).run();
    stored.in_map = owner.in_map;
    stored.placement_revision = revision;
  }
}

bool PlacementWriter::remove_others() {
  bool is_late = false;
  for (auto& [key, stored] : *stored_) {
    if (!stored.may_have_others) continue;
    if (is_late) return false;
    for (const char* table : kTables)
      Statement(db_, fmt::format("DELETE FROM {} WHERE submap = ? AND revision NOT IN (?, ?)", table))
          .bind(stored.row, stored.placement_revision, stored.written_placement_revision)
          .run();
    // The previous placement is needed until the written one is valid.
    stored.may_have_others = stored.placement_revision != stored.written_placement_revision;
    is_late = std::chrono::steady_clock::now() >= deadline_;
  }
  return true;
}

void read_placements(Database& database, const SubmapsByRow& keys, const StoredSubmaps& stored, Atlas* atlas) {
  std::map<SubmapKey, Placement> placements;
  Statement keyframes(database, select_placed("p.utime, p.map_from_submap", "placed_keyframes"));
  while (keyframes.step())
    placements[key_of(keyframes.integer(0), keys)].map_from_submap[keyframes.integer(1)] =
        checked_similarity(keyframes.blob(2));
  Statement landmarks(database, select_placed("p.id, p.position", "placed_landmarks"));
  while (landmarks.step()) {
    const auto position = array_from_blob<std::array<double, 3>>(landmarks.blob(2));
    const Eigen::Vector3d in_map(position[0], position[1], position[2]);
    if (!in_map.allFinite()) throw std::runtime_error("the place of a landmark is none");
    placements[key_of(landmarks.integer(0), keys)].landmarks[static_cast<int>(landmarks.integer(1))] = in_map;
  }
  Statement fused(database, select_placed("p.id, p.into_submap, p.into_id", "fused_landmarks"));
  while (fused.step())
    placements[key_of(fused.integer(0), keys)].fused[static_cast<int>(fused.integer(1))] = {
        key_of(fused.integer(2), keys), static_cast<int>(fused.integer(3))};
  for (const auto& [row, key] : keys) {
    placements[key].revision = stored.at(key).placement_revision;
    atlas->restore_placement(key, std::move(placements[key]));
  }
}

}  // namespace rumi::map_server
