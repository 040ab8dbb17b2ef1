// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/map_migrations.h"

#include "map_server/store/map_schema.h"

namespace rumi::map_server {
namespace {

// Released steps never change. A step uses a constant of map_schema.h only if it creates the table in its present form:
// whoever changes that table must first copy the old text into the step.
struct Migration {
  int from = 0;  // the step leads from this version to the next; a version may have several steps
  const char* sql = nullptr;
};

// Version 1 had no tables for placements.
constexpr const char* kPlacements2 = R"sql(
CREATE TABLE placed_keyframes (submap INTEGER NOT NULL REFERENCES submaps, utime INTEGER NOT NULL,
  map_from_submap BLOB NOT NULL, PRIMARY KEY (submap, utime)) WITHOUT ROWID;
CREATE TABLE placed_landmarks (submap INTEGER NOT NULL REFERENCES submaps, id INTEGER NOT NULL,
  position BLOB NOT NULL, PRIMARY KEY (submap, id)) WITHOUT ROWID;
CREATE TABLE fused_landmarks (submap INTEGER NOT NULL REFERENCES submaps, id INTEGER NOT NULL,
  into_submap INTEGER NOT NULL REFERENCES submaps (submap), into_id INTEGER NOT NULL,
  PRIMARY KEY (submap, id)) WITHOUT ROWID;
)sql";

// Version 1 had one similarity for a whole submap, and only the identity (the blob below) was ever written. Any other
// similarity becomes that of the submap's first keyframe, which all other keyframes then follow.
constexpr const char* kPlacementsOf1 = R"sql(
ALTER TABLE submaps ADD COLUMN placement_revision INTEGER NOT NULL DEFAULT 0;
INSERT INTO placed_keyframes
  SELECT s.submap, min(k.utime), s.map_from_submap
  FROM submaps s JOIN keyframes k ON k.submap = s.submap
  WHERE s.in_map AND s.map_from_submap <>
    x'000000000000F03F000000000000F03F000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000'
  GROUP BY s.submap;
UPDATE submaps SET placement_revision = (SELECT max(map_revision, 1) FROM atlas)
  WHERE submap IN (SELECT submap FROM placed_keyframes);
ALTER TABLE submaps DROP COLUMN map_from_submap;
)sql";

// Version 3 did not store the standard deviations of poses.
constexpr const char* kSigmas4 = R"sql(
ALTER TABLE frame_poses ADD COLUMN position_sigma REAL;
ALTER TABLE frame_poses ADD COLUMN rotation_sigma_rad REAL;
ALTER TABLE frame_poses ADD COLUMN log_scale_sigma REAL;
)sql";

// Version 4 had one placement per submap, which could only be replaced at once; version 5 has several, each with a
// revision.
constexpr const char* kRenamePlacements4 = R"sql(
ALTER TABLE placed_keyframes RENAME TO placed_keyframes_4;
ALTER TABLE placed_landmarks RENAME TO placed_landmarks_4;
ALTER TABLE fused_landmarks RENAME TO fused_landmarks_4;
)sql";
constexpr const char* kCopyPlacements4 = R"sql(
INSERT INTO placed_keyframes SELECT p.submap, s.placement_revision, p.utime, p.map_from_submap
  FROM placed_keyframes_4 p JOIN submaps s ON s.submap = p.submap;
INSERT INTO placed_landmarks SELECT p.submap, s.placement_revision, p.id, p.position
  FROM placed_landmarks_4 p JOIN submaps s ON s.submap = p.submap;
INSERT INTO fused_landmarks SELECT p.submap, s.placement_revision, p.id, p.into_submap, p.into_id
  FROM fused_landmarks_4 p JOIN submaps s ON s.submap = p.submap;
DROP TABLE placed_keyframes_4;
DROP TABLE placed_landmarks_4;
DROP TABLE fused_landmarks_4;
)sql";

// Version 4 had the same image pyramid for all submaps.
constexpr const char* kPyramids5 = R"sql(
ALTER TABLE submaps ADD COLUMN levels INTEGER NOT NULL DEFAULT 8;
ALTER TABLE submaps ADD COLUMN scale_factor REAL NOT NULL DEFAULT 1.2;
)sql";

// Version 5 did not store the stream of a session: each session gets a stream of its own. From version 6 on a frame is
// identified by stream and time.
constexpr const char* kStreams6 = R"sql(
ALTER TABLE submaps ADD COLUMN stream INTEGER NOT NULL DEFAULT 0;
UPDATE submaps SET stream = session;
ALTER TABLE frames RENAME TO frames_5;
)sql";
constexpr const char* kCopyFrames5 = R"sql(
INSERT INTO frames SELECT session, utime, session, state, submap FROM frames_5;
DROP TABLE frames_5;
)sql";

constexpr const char* kDropRemoved = "DROP TABLE removed";  // the table grew without limit

constexpr Migration kMapMigrations[] = {
    {1, kPlacements2},       {1, kLinksTable},      {1, kPlacementsOf1},   {2, kDropRemoved}, {3, kSigmas4},
    {4, kRenamePlacements4}, {4, kPlacementTables}, {4, kCopyPlacements4}, {4, kPyramids5},   {5, kStreams6},
    {5, kFramesTable},       {5, kCopyFrames5},     {6, kMasksTable},
};

}  // namespace

void create_map_tables(Database& database) {
  for (const char* sql : {kSubmapTables, kPlacementTables, kLinksTable, kFramesTable, kMasksTable})
    database.execute(sql);
}

void migrate_map(Database& database, int64_t version) {
  for (const Migration& step : kMapMigrations)
    if (step.from >= version) database.execute(step.sql);
}

}  // namespace rumi::map_server
