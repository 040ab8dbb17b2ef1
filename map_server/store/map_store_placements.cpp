// SPDX-License-Identifier: BSD-3-Clause
// Which submaps form the map, where they lie in it, and how they hang together: writing and reading.
#include <fmt/format.h>

#include <stdexcept>

#include "map_server/store/blob.h"
#include "map_server/store/map_store.h"

namespace rumi::map_server {
namespace {

constexpr const char* kPlacementTables[] = {"placed_keyframes", "placed_landmarks", "fused_landmarks"};

Sim3 checked_similarity(std::span<const uint8_t> blob) {
  const Sim3 similarity = similarity_from_numbers(array_from_blob<SimilarityNumbers>(blob));
  if (!similarity.is_finite() || similarity.scale <= 0) throw std::runtime_error("a similarity is none");
  return similarity;
}

SubmapKey key_of(int64_t row, const std::map<int64_t, SubmapKey>& keys) {
  const auto key = keys.find(row);
  if (key == keys.end()) throw std::runtime_error(fmt::format("submap {} is placed or linked but missing", row));
  return key->second;
}

// Of the placements that count. A submap that is placed but missing is found, too.
std::string select_placed(const std::string& columns, const std::string& table) {
  return fmt::format(
      "SELECT p.submap, {} FROM {} p LEFT JOIN submaps s ON s.submap = p.submap "
      "WHERE p.revision IS coalesce(s.placement_revision, p.revision)",
      columns, table);
}

}  // namespace

// True when all are written. One is at every call, so that there is an end.
bool MapStore::save_placements(const Atlas& atlas, Deadline deadline, Rows* rows) {
  bool is_late = false;
  for (const auto& [key, owner] : atlas.submaps()) {
    Stored& stored = rows->at(key);
    if (stored.written_placement_revision == owner.placement.revision) continue;
    if (is_late) return false;
    save_placement(owner.placement, stored.row, *rows);
    stored.written_placement_revision = owner.placement.revision;
    stored.has_others = true;
    is_late = std::chrono::steady_clock::now() >= deadline;
  }
  return true;
}

void MapStore::save_placement(const Placement& placement, int64_t row, const Rows& rows) {
  // Whoever died in the middle may have left some of a revision that now comes again.
  for (const char* table : kPlacementTables)
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
    fused.bind(row, placement.revision, id, rows.at(into.submap).row, into.id).run();
}

// From here on what was written counts.
void MapStore::save_map(const Atlas& atlas, Rows* rows) {
  Statement(db_, "UPDATE atlas SET map_revision = ?1 WHERE map_revision <> ?1").bind(atlas.revision()).run();
  Statement update(db_, "UPDATE submaps SET in_map = ?, placement_revision = ? WHERE submap = ?");
  for (const auto& [key, owner] : atlas.submaps()) {
    Stored& stored = rows->at(key);
    const int64_t revision = owner.placement.revision;
    if (owner.in_map == stored.in_map && revision == stored.placement_revision) continue;
    update.bind(owner.in_map, revision, stored.row).run();
    stored.in_map = owner.in_map;
    stored.placement_revision = revision;
  }
}

// True when there are none left.
bool MapStore::remove_other_placements(Deadline deadline, Rows* rows) {
  bool is_late = false;
  for (auto& [key, stored] : *rows) {
    if (!stored.has_others) continue;
    if (is_late) return false;
    for (const char* table : kPlacementTables)
      Statement(db_, fmt::format("DELETE FROM {} WHERE submap = ? AND revision NOT IN (?, ?)", table))
          .bind(stored.row, stored.placement_revision, stored.written_placement_revision)
          .run();
    // The one that counts until then is still there.
    stored.has_others = stored.placement_revision != stored.written_placement_revision;
    is_late = std::chrono::steady_clock::now() >= deadline;
  }
  return true;
}

void MapStore::save_links(const Atlas& atlas, const Rows& rows) {
  if (atlas.links() == stored_links_) return;
  db_.execute("DELETE FROM links");
  Statement insert(db_, "INSERT INTO links VALUES (NULL, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (const Link& link : atlas.links()) {
    const SimilarityNumbers b_from_a = similarity_numbers(link.b_from_a);
    insert
        .bind(rows.at(link.a).row, rows.at(link.b).row, static_cast<int>(link.kind), as_blob(b_from_a), link.keyframes,
              link.keyframe_inliers, link.landmarks, link.landmark_inliers, link.rmse_px, link.accepted(), link.doubt,
              atlas.revision())
        .run();
  }
}

void MapStore::load_placements(Atlas* atlas, const std::map<int64_t, SubmapKey>& keys) {
  std::map<SubmapKey, Placement> placements;
  Statement keyframes(db_, select_placed("p.utime, p.map_from_submap", "placed_keyframes"));
  while (keyframes.step())
    placements[key_of(keyframes.integer(0), keys)].map_from_submap[keyframes.integer(1)] =
        checked_similarity(keyframes.blob(2));
  Statement landmarks(db_, select_placed("p.id, p.position", "placed_landmarks"));
  while (landmarks.step()) {
    const auto position = array_from_blob<std::array<double, 3>>(landmarks.blob(2));
    const Eigen::Vector3d in_map(position[0], position[1], position[2]);
    if (!in_map.allFinite()) throw std::runtime_error("the place of a landmark is none");
    placements[key_of(landmarks.integer(0), keys)].landmarks[static_cast<int>(landmarks.integer(1))] = in_map;
  }
  Statement fused(db_, select_placed("p.id, p.into_submap, p.into_id", "fused_landmarks"));
  while (fused.step())
    placements[key_of(fused.integer(0), keys)].fused[static_cast<int>(fused.integer(1))] = {
        key_of(fused.integer(2), keys), static_cast<int>(fused.integer(3))};
  for (auto& [row, key] : keys) {
    placements[key].revision = stored_.at(key).placement_revision;
    atlas->restore_placement(key, std::move(placements[key]));
  }
}

void MapStore::load_links(Atlas* atlas, const std::map<int64_t, SubmapKey>& keys) {
  Statement rows(
      db_,
      "SELECT a, b, kind, b_from_a, keyframes, keyframe_inliers, landmarks, landmark_inliers, rmse_px, doubt "
      "FROM links ORDER BY link");
  std::vector<Link> links;
  while (rows.step()) {
    Link& link = links.emplace_back();
    link.a = key_of(rows.integer(0), keys);
    link.b = key_of(rows.integer(1), keys);
    link.kind = rows.integer(2) == 0 ? Link::Kind::kSameImages : Link::Kind::kAppearance;
    link.b_from_a = checked_similarity(rows.blob(3));
    int column = 4;
    for (int* count : {&link.keyframes, &link.keyframe_inliers, &link.landmarks, &link.landmark_inliers})
      *count = static_cast<int>(rows.integer(column++));
    link.rmse_px = rows.real(8);
    const std::span<const uint8_t> doubt = rows.blob(9);
    link.doubt.assign(doubt.begin(), doubt.end());
  }
  stored_links_ = links;
  atlas->set_links(std::move(links));
}

}  // namespace rumi::map_server
