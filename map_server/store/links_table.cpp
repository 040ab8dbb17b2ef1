// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/links_table.h"

#include <span>
#include <utility>
#include <vector>

#include "base/or_throw.h"
#include "map_server/store/blob.h"
#include "map_server/store/submap_values.h"

namespace rumi::map_server {

void write_links(const Atlas& atlas, const StoredSubmaps& stored, Database& database) {
  database.execute("DELETE FROM links");
  Statement insert(database, "INSERT INTO links VALUES (NULL, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (const Link& link : atlas.links()) {
    const SimilarityNumbers b_from_a = similarity_numbers(link.b_from_a);
    insert
        .bind(stored.at(link.a).row, stored.at(link.b).row, static_cast<int>(link.kind), as_blob(b_from_a),
              link.keyframes, link.keyframe_inliers, link.landmarks, link.landmark_inliers, link.rmse_px,
              link.accepted(), link.doubt, atlas.revision())
        .run();
  }
}

void read_links(Database& database, const SubmapsByRow& keys, Atlas* atlas) {
  Statement rows(
      database,
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
  or_throw(atlas->set_links(std::move(links)));
}

}  // namespace rumi::map_server
